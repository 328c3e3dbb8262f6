#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/answers.hpp"

namespace landmarkdb::client {

// Scenes for scripts (the indexer prints the same keys) and for people.
nlohmann::ordered_json scene_json(const SceneInfo& scene);  // with versions where it has them
nlohmann::ordered_json scenes_json(const std::vector<SceneInfo>& scenes);  // {"scenes": [...]}
std::string scene_text(const SceneInfo& scene);
std::string scenes_text(const std::vector<SceneInfo>& scenes);

}  // namespace landmarkdb::client
