#pragma once

#include <nlohmann/json.hpp>

#include "bench/mono/cases.hpp"

namespace landmarkdb::bench {

// Fits on generated scenes and rendered pictures of their own seeds (from 1) and prints: how much
// of the edges of right and wrong hypotheses lies on the image's (PoseCheck::score_edges), the
// least number of false alarms of a wrong one (what ends a search), and the weights of the
// confidence.
nlohmann::json calibrate(const Settings& settings);

// Asks rendered pictures from settings.seed on and prints how many answers are right by confidence.
nlohmann::json reliability(const Settings& settings);

}  // namespace landmarkdb::bench
