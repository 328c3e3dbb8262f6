#pragma once

#include <nlohmann/json.hpp>

#include "bench/mono/cases.hpp"

namespace landmarkdb::bench {

// Of rendered pictures with a known object (settings.seed on, those of `reliability`): how many
// each stage loses. The true pose is put to the test by itself, so that a search that never came to
// it can be told from a test that does not let it pass. Prints the counts.
nlohmann::json funnel(const Settings& settings);

}  // namespace landmarkdb::bench
