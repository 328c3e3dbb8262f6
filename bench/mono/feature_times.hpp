#pragma once

#include <nlohmann/json.hpp>

#include "bench/mono/cases.hpp"

namespace landmarkdb::bench {

// How long the features of rendered pictures (settings.seed on, 640 x 480) take, in processor time
// of one thread: the least of a few turns each. Also of the half with the most edges.
nlohmann::json feature_times(const Settings& settings);

}  // namespace landmarkdb::bench
