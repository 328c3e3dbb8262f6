#include "engine/features/structure_keypoints.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::add_point;
using testing::every;

TEST(NormalSpread, IsNothingOnAPlaneAHalfOnAnEdgeAndAThirdOnABall) {
  PreparedCloud plane;
  PreparedCloud edge;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      add_point(plane, {0.1 * i, 0.1 * j, 0}, {0, 0, 1});
      add_point(edge, {0.1 * i, 0.1 * j, 0.0}, {0, 0, 1});
      add_point(edge, {0.1 * i, 0.0, 0.1 * j}, {0, 1, 0});
    }
  }
  Random random(1);
  PreparedCloud ball;
  testing::add_sphere(ball, {0, 0, 0}, 1.0, 4000, random);
  Keypoints first;
  first.index = {0};
  EXPECT_NEAR(normal_spread(plane, first, 100.0, {})[0], 0.0F, 1e-6F);
  EXPECT_NEAR(normal_spread(edge, first, 100.0, {})[0], 0.5F, 1e-5F);
  EXPECT_NEAR(normal_spread(ball, first, 100.0, {})[0], 1.0F / 3.0F, 0.02F);
}

TEST(NormalSpread, LooksNoFartherThanItsRadius) {
  PreparedCloud cloud;
  add_point(cloud, {0, 0, 0}, {0, 0, 1});
  add_point(cloud, {0.1, 0, 0}, {0, 0, 1});
  add_point(cloud, {0.5, 0, 0}, {1, 0, 0});
  const std::vector<float> near = normal_spread(cloud, every(cloud, 1), 0.2, {});
  EXPECT_EQ(near, (std::vector<float>{0.0F, 0.0F, 0.0F}));
  const std::vector<float> far = normal_spread(cloud, every(cloud, 1), 0.6, {});
  EXPECT_NEAR(far[0], 1.0F / 3.0F, 1e-6F);
}

TEST(NormalSpread, DoesNotSeeTheNormalsSign) {
  PreparedCloud cloud;
  for (int i = 0; i < 10; ++i) add_point(cloud, {0.1 * i, 0, 0}, {0, 0, i % 2 == 0 ? 1.0 : -1.0});
  EXPECT_NEAR(normal_spread(cloud, every(cloud, 10), 5.0, {})[0], 0.0F, 1e-6F);
}

TEST(UniformKeypoints, TakesTheLowerIndexOfTwoAsNear) {
  PreparedCloud cloud;
  add_point(cloud, {1, 1, 1}, {0, 0, 1});
  add_point(cloud, {0, 0, 0}, {0, 0, 1});
  add_point(cloud, {0, 0, 0}, {0, 0, 1});
  const Keypoints found = uniform_keypoints(cloud, 0.9);
  EXPECT_EQ(found.index, (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace landmarkdb
