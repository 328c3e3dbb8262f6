#include "engine/registration/plane_layout.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/plane_surface.hpp"

namespace landmarkdb {
namespace {

using testing::random_pose;
using testing::room;
using Surface = testing::PlaneSurface;

TEST(LayOutPlanes, FindsTheFrameHoweverTheRoomIsTurned) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d T = random_pose(random);
    const auto layouts = room().moved(T).layouts();
    ASSERT_EQ(layouts.size(), 1U);
    const Eigen::Matrix3d M = T.linear().transpose() * layouts[0].axes.cast<double>();
    for (int k = 0; k < 3; ++k) EXPECT_GT(M.col(k).cwiseAbs().maxCoeff(), 0.998);
    EXPECT_NEAR(layouts[0].axes.determinant(), 1.0F, 1e-4F);
  }
}

TEST(LayOutPlanes, GivesASecondFrameOnlyWhereOneIs) {
  Surface turned = room();
  EXPECT_EQ(turned.layouts(2).size(), 1U);
  turned.add({0, 0, 3}, {0, 5, 0}, {8, 0, 0});  // the ceiling: most faces up or down
  const float diagonal = std::sqrt(0.5F);
  turned.add({3, 3, 0}, {6 * diagonal, 6 * diagonal, 0}, {0, 0, 3});
  turned.add({3, 3, 0}, {0, 0, 3}, {-6 * diagonal, 6 * diagonal, 0});
  EXPECT_EQ(turned.layouts(2).size(), 2U);
}

TEST(LayOutPlanes, HasNoneForABallALoneWallAndNothing) {
  Random random(5);
  Surface ball;
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d n =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    ball.points.push_back((3.0 * n).cast<float>());
    ball.normals.push_back((-n).cast<float>());
  }
  EXPECT_TRUE(ball.layouts().empty());
  Surface wall;
  wall.add({0, 0, 0}, {4, 0, 0}, {0, 0, 3});
  EXPECT_TRUE(wall.layouts().empty());
  EXPECT_TRUE(Surface().layouts().empty());
}

}  // namespace
}  // namespace landmarkdb
