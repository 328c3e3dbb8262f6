#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "store/store_types.hpp"

// How scenes look from outside: JSON for scripts (the keys are the wire's), tables for people.
namespace landmarkdb::indexer {

std::string_view kind_name(EntryKind kind);                    // "place", "object"
std::string_view keypoint_method_name(KeypointMethod method);  // "uniform", ...

nlohmann::ordered_json options_json(const FeatureOptions& options);
nlohmann::ordered_json landmark_json(const Landmark& landmark);
nlohmann::ordered_json landmarks_json(const std::vector<Landmark>& landmarks);
// With `with_versions`, all of them beside the active one's figures.
nlohmann::ordered_json scene_json(const SceneSummary& scene, bool with_versions);

std::string scenes_text(const std::vector<SceneSummary>& scenes);
std::string scene_text(const SceneSummary& scene);
std::string landmarks_text(const std::vector<Landmark>& landmarks);

}  // namespace landmarkdb::indexer
