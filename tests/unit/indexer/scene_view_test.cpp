#include "indexer/scene_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::indexer {
namespace {

using ::testing::HasSubstr;

SceneSummary sample() {
  SceneSummary scene;
  scene.id = 7;
  scene.name = "lobby";
  scene.active_version = 2;
  scene.points = 12345;
  scene.keypoints = 678;
  scene.bytes = 1 << 20;
  scene.created = "2024-05-01T12:00:00Z";
  scene.options.voxel_m = 0.02;
  scene.up = Eigen::Vector3d(0, 0, 1);
  scene.sources = {"lobby.ply"};
  scene.tags = {{"floor", "2"}};
  scene.versions.resize(2);
  scene.versions[0].version = 1;
  scene.versions[1].version = 2;
  scene.versions[1].active = true;
  scene.landmarks = {{"vents", {0, 0, 2}, {1, 1, 3}}};
  return scene;
}

TEST(SceneJson, HasTheKeysScriptsReadFor) {
  const auto object = scene_json(sample(), true);
  EXPECT_EQ(object.at("name"), "lobby");
  EXPECT_EQ(object.at("version"), 2);
  EXPECT_EQ(object.at("state"), "active");
  EXPECT_EQ(object.at("options").at("voxel_m"), 0.02);
  EXPECT_EQ(object.at("options").at("keypoints"), "structure");
  EXPECT_EQ(object.at("up"), nlohmann::ordered_json({0.0, 0.0, 1.0}));
  EXPECT_EQ(object.at("versions").size(), 2U);
  EXPECT_EQ(object.at("landmarks")[0].at("max_m")[2], 3.0);
  EXPECT_FALSE(scene_json(sample(), false).contains("versions"));
}

TEST(SceneJson, SaysWhyADamagedSceneIsNotServed) {
  SceneSummary scene = sample();
  scene.damage = "points: digest differs";
  scene.up.reset();
  const auto object = scene_json(scene, false);
  EXPECT_EQ(object.at("state"), "quarantined");
  EXPECT_EQ(object.at("state_reason"), "points: digest differs");
  EXPECT_TRUE(object.at("up").is_null());
}

TEST(LandmarksJson, IsAnArrayAlsoOfOneAndNone) {
  EXPECT_TRUE(landmarks_json({}).is_array());
  EXPECT_TRUE(landmarks_json(sample().landmarks).is_array());
}

TEST(ScenesText, IsATableWithOneLineAScene) {
  EXPECT_EQ(scenes_text({sample()}),
            "NAME   KIND   VERSION  POINTS  KEYPOINTS     SIZE  CREATED               STATE\n"
            "lobby  place        2  12,345        678  1.0 MiB  2024-05-01T12:00:00Z  active\n");
}

TEST(SceneText, ShowsVersionsAndLandmarks) {
  const std::string text = scene_text(sample());
  EXPECT_THAT(text, HasSubstr("up                0, 0, 1\n"));
  EXPECT_THAT(text, HasSubstr("tags              floor=2\n"));
  EXPECT_THAT(text, HasSubstr("vents"));
}

}  // namespace
}  // namespace landmarkdb::indexer
