#pragma once

#include <nlohmann/json.hpp>

#include "bench/mono/cases.hpp"

namespace landmarkdb::bench {

// How long a recogniser of settings.models generated models with stored indices takes to be ready
// (processor time, one thread), and what it takes to hold; also of the first image without links.
nlohmann::json ready(const Settings& settings);

}  // namespace landmarkdb::bench
