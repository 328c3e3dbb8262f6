#include "datasets/objects/object_scene.hpp"

#include <gtest/gtest.h>

namespace landmarkdb::datasets {
namespace {

TEST(MakeObjectScene, StandsThingsOnTheTableAndKnowsWhatIsSeenOfThem) {
  const ObjectModel figurine = make_object({.kind = ObjectKind::kFigurine, .seed = 2});
  const ObjectModel mug = make_object({.kind = ObjectKind::kMug, .seed = 4});
  const std::vector<const ObjectModel*> models = {&figurine, &mug, &figurine};
  ObjectSceneOptions options;
  options.seed = 7;
  const ObjectScene scene = make_object_scene(models, options, {});
  ASSERT_EQ(scene.things.size(), 3U);
  std::size_t pixels = 0;
  for (const Standing& thing : scene.things) {
    EXPECT_GE(thing.unhidden, 0.0);
    EXPECT_LE(thing.unhidden, 1.0);
    pixels += thing.pixels;
    // The lowest point lies on the table.
    double lowest = 1e9;
    for (const Eigen::Vector3f& p : models[thing.model]->mesh.vertices) {
      lowest = std::min(lowest, (thing.T_scene_object * p.cast<double>()).z());
    }
    EXPECT_NEAR(lowest, 0.74, 1e-4);
  }
  EXPECT_GT(pixels, 500U);
  EXPECT_GT(scene.frame.valid, 100'000U);
  RunContext two;
  two.threads = 2;
  const ObjectScene again = make_object_scene(models, options, two);
  EXPECT_EQ(again.things[1].pixels, scene.things[1].pixels);
  EXPECT_TRUE(again.things[1].T_scene_object.isApprox(scene.things[1].T_scene_object, 0.0));
}

}  // namespace
}  // namespace landmarkdb::datasets
