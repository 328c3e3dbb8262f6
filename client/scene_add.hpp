#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "client/answers.hpp"

namespace landmarkdb::client {

// `scene add` as it is typed.
struct SceneAddArguments {
  std::string name;
  std::vector<std::string> clouds;
  std::string kind = "place";
  std::vector<std::string> poses;       // none, or one a cloud
  std::vector<std::string> viewpoints;  // none, or one a cloud
  std::string keypoints;
  std::string voxel;
  std::string radius;
  std::string up;
  std::string units = "m";
};

void add_scene_add_options(CLI::App& command, SceneAddArguments& arguments);

// Reads the files. Throws cli::UsageError and Error.
SceneAdd load_scene(const SceneAddArguments& arguments);

}  // namespace landmarkdb::client
