#include "engine/registration/settle.hpp"

#include <gtest/gtest.h>

#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::Surface;

constexpr double kCell_m = 0.15;

Eigen::Isometry3d settled(const SurfaceGrid& grid,
                          const TestPoints& test,
                          const Eigen::Isometry3d& start,
                          const SettleOptions& options) {
  Eigen::Matrix3f R = start.linear().cast<float>();
  Eigen::Vector3f t = start.translation().cast<float>();
  settle_pose(grid, test, options, R, t);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R.cast<double>();
  T.translation() = t.cast<double>();
  return T;
}

TEST(SettlePose, BringsAPoseThatIsDecimetresOffHome) {
  const Surface corner = testing::corner_room(0.04);
  const SurfaceGrid grid(corner.points, corner.normals, kCell_m, 2);
  const TestPoints test = select_test_points(corner.points, corner.normals, {}, 512, 1);
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Eigen::Isometry3d start = testing::random_pose(random, 0.1, 0.12);
    const Eigen::Isometry3d T = settled(grid, test, start, {.points = 128, .iterations = 8});
    EXPECT_THAT(T, PoseNear(Eigen::Isometry3d::Identity(), 0.02, 0.02)) << round;
  }
}

TEST(SettlePose, DoesNotSlideAlongAWall) {
  const Surface wall = testing::lone_wall(0.04);
  const SurfaceGrid grid(wall.points, wall.normals, kCell_m, 2);
  const TestPoints test = select_test_points(wall.points, wall.normals, {}, 512, 1);
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation() = Eigen::Vector3d(0.3, -0.2, 0.1);
  const Eigen::Isometry3d T = settled(grid, test, start, {.iterations = 6});
  EXPECT_NEAR(T.translation().x(), 0.3, 0.01);
  EXPECT_NEAR(T.translation().y(), -0.2, 0.01);
  EXPECT_NEAR(T.translation().z(), 0.0, 0.01);
}

TEST(SettlePose, LeavesAPoseThatMeetsNothing) {
  const Surface corner = testing::corner_room(0.1);
  const SurfaceGrid grid(corner.points, corner.normals, kCell_m, 2);
  const TestPoints test = select_test_points(corner.points, corner.normals, {}, 512, 1);
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation().x() = 100.0;
  EXPECT_EQ(settled(grid, test, start, {}).matrix(), start.matrix());
  EXPECT_EQ(settled(grid, TestPoints{}, start, {}).matrix(), start.matrix());
}

TEST(SettlePose, KeepsARotation) {
  const Surface corner = testing::corner_room(0.05);
  const SurfaceGrid grid(corner.points, corner.normals, kCell_m, 2);
  const TestPoints test = select_test_points(corner.points, corner.normals, {}, 512, 1);
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    const Eigen::Matrix3d R =
        settled(grid, test, testing::random_pose(random, 3.0, 1.5), {.iterations = 4}).linear();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-4);
    EXPECT_GT(R.determinant(), 0.0);
  }
}

}  // namespace
}  // namespace landmarkdb
