#include "client/scene_add.hpp"

#include <gmock/gmock.h>

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

TEST(LoadScene, WantsOnePoseAndOneViewpointACloudOrNone) {
  SceneAddArguments arguments;
  arguments.name = "yard";
  arguments.clouds = {"a.pcd", "b.pcd"};
  arguments.poses = {"a.txt"};
  EXPECT_THROW(load_scene(arguments), cli::UsageError);
  arguments.poses.clear();
  arguments.viewpoints = {"0,0,1", "0,0,1", "0,0,1"};
  EXPECT_THROW(load_scene(arguments), cli::UsageError);
}

TEST(LoadScene, ChecksNumbersBeforeItReadsFiles) {
  SceneAddArguments arguments;
  arguments.name = "yard";
  arguments.clouds = {"/nowhere/a.pcd"};
  arguments.voxel = "-0.1";
  EXPECT_THROW(load_scene(arguments), cli::UsageError);
  arguments.voxel.clear();
  EXPECT_THROW(load_scene(arguments), Error);
}

}  // namespace
}  // namespace landmarkdb::client
