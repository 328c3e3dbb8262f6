#include "client/render_scenes.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

SceneInfo lobby() {
  SceneInfo scene;
  scene.name = "lobby";
  scene.version = 2;
  scene.points = 245'685;
  scene.tags = {{"floor", "2"}};
  scene.landmarks = {{.name = "desk", .max_m = {1.0, 2.0, 3.0}}};
  scene.sources = {"lobby.ply"};
  SceneVersion version;
  version.version = 2;
  version.created = "2024-05-01T00:00:00Z";
  version.active = true;
  scene.versions = {version};
  return scene;
}

TEST(SceneJson, HoldsWhatTheServerTold) {
  const nlohmann::ordered_json json = scene_json(lobby());
  EXPECT_EQ(json["name"], "lobby");
  EXPECT_EQ(json["kind"], "place");
  EXPECT_EQ(json["state"], "active");
  EXPECT_EQ(json["points"], 245'685);
  EXPECT_EQ(json["options"]["keypoints"], "structure");
  EXPECT_EQ(json["tags"]["floor"], "2");
  EXPECT_EQ(json["landmarks"][0]["max_m"][2], 3.0);
  EXPECT_TRUE(json["up"].is_null());
  EXPECT_EQ(json["versions"][0]["active"], true);
  EXPECT_FALSE(json.contains("state_reason"));
}

TEST(SceneJson, WritesNoTagsAsAnEmptyObject) {
  EXPECT_EQ(scene_json(SceneInfo{})["tags"], nlohmann::ordered_json::object());
}

TEST(SceneJson, SaysWhyASceneIsNotServed) {
  SceneInfo scene = lobby();
  scene.quarantined = true;
  scene.state_reason = "digest";
  EXPECT_EQ(scene_json(scene)["state"], "quarantined");
  EXPECT_EQ(scene_json(scene)["state_reason"], "digest");
  EXPECT_THAT(scene_text(scene), HasSubstr("damaged, not served: digest"));
}

TEST(ScenesText, IsATableOrSaysThatThereIsNothing) {
  EXPECT_EQ(scenes_text({}), "no scenes\n");
  EXPECT_THAT(scenes_text({lobby()}), AllOf(HasSubstr("NAME"), HasSubstr("245,685")));
}

TEST(SceneText, ShowsVersionsLandmarksAndTags) {
  EXPECT_THAT(scene_text(lobby()),
              AllOf(HasSubstr("floor=2"), HasSubstr("desk"), HasSubstr("2024-05-01")));
}

TEST(SceneJson, ShowsBoundsAndDamageWhereTheyAreKnown) {
  SceneInfo scene = lobby();
  EXPECT_FALSE(scene_json(scene).contains("min_m"));
  scene.min_m = Eigen::Vector3d(-1, 0, 0);
  scene.max_m = Eigen::Vector3d(4, 5, 6);
  scene.versions[0].damage = "digest of points";
  const nlohmann::ordered_json json = scene_json(scene);
  EXPECT_EQ(json["min_m"][0], -1.0);
  EXPECT_EQ(json["versions"][0]["damage"], "digest of points");
  EXPECT_THAT(scene_text(scene),
              AllOf(HasSubstr("-1, 0, 0"), HasSubstr("active, damaged: digest")));
}

TEST(ScenesJson, WrapsTheListInAnObject) {
  EXPECT_EQ(scenes_json({lobby(), lobby()})["scenes"].size(), 2U);
}

}  // namespace
}  // namespace landmarkdb::client
