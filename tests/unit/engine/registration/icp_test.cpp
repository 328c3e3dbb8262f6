#include "engine/registration/icp.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::random_pose;
using testing::Surface;

constexpr double kCell_m = 0.05;
constexpr double kDegree = std::numbers::pi / 180.0;

SurfaceGrid grid_of(const Surface& surface) {
  return SurfaceGrid(surface.points, surface.normals, kCell_m, 2);
}

TEST(RefineIcp, ConvergesFromFiveCentimetresAndThreeDegrees) {
  const SurfaceGrid grid = grid_of(testing::corner_room(0.04, 1));
  const Surface again = testing::corner_room(0.06, 2);  // other points of the same surface
  Random random(1);
  for (int round = 0; round < 30; ++round) {
    const Eigen::Isometry3d T_room_sensor = random_pose(random, 3.0, 5.0);
    const Surface source = again.seen_from(T_room_sensor);
    // Off about the middle of the room, as a pose from a local reference frame is.
    Eigen::Isometry3d off = random_pose(random, 3.0 * kDegree, 0.03);
    const Eigen::Vector3d middle(1.2, 1.2, 0.8);
    off.translation() += middle - off.linear() * middle;
    const IcpResult result =
        refine_icp(grid, source.points, source.normals, off * T_room_sensor, {});
    EXPECT_THAT(result.T_target_source, PoseNear(T_room_sensor, 0.004, 0.002));
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.rmse_m, 0.005);
    EXPECT_GT(result.paired, 0.97);
    EXPECT_TRUE(result.centre_target.isApprox(
        result.T_target_source * (T_room_sensor.inverse() * result.centre_target), 0.01));
  }
}

TEST(RefineIcp, StaysWhereItIsRight) {
  const Surface room = testing::corner_room(0.05);
  const IcpResult result =
      refine_icp(grid_of(room), room.points, room.normals, Eigen::Isometry3d::Identity(), {});
  EXPECT_THAT(result.T_target_source, PoseNear(Eigen::Isometry3d::Identity(), 1e-3, 1e-3));
  EXPECT_LT(result.rmse_m, 2e-3);
}

TEST(RefineIcp, LeavesASlideAndATurnInItsPlaneAloneForALoneWall) {
  const SurfaceGrid grid = grid_of(testing::lone_wall(0.04, 1));
  Surface source = testing::lone_wall(0.06, 2);
  Surface part;  // its middle: no edge may tell where it is
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    if (source.points[i].cwiseAbs().maxCoeff() > 1.0F) continue;
    part.points.push_back(source.points[i]);
    part.normals.push_back(source.normals[i]);
  }
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.linear() = rotation_from_vector({0.02, -0.01, 0.3});
  start.translation() = Eigen::Vector3d(0.31, -0.22, 0.04);
  const IcpResult result = refine_icp(grid, part.points, part.normals, start, {});
  const Eigen::Isometry3d& T = result.T_target_source;
  EXPECT_NEAR(T.translation().z(), 0.0, 1e-4);
  EXPECT_LT((T.linear().col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-4);
  EXPECT_NEAR(T.translation().x(), 0.31, 2e-3);
  EXPECT_NEAR(T.translation().y(), -0.22, 2e-3);
  EXPECT_NEAR(std::atan2(T(1, 0), T(0, 0)), 0.3, 2e-3);
  EXPECT_TRUE(result.converged);
}

TEST(RefineIcp, LeavesASlideAloneInACorridor) {
  const SurfaceGrid grid = grid_of(testing::corridor(0.05, 1));
  Surface source = testing::corridor(0.08, 2);
  Surface part;
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    if (std::abs(source.points[i].x()) > 2.0F) continue;
    part.points.push_back(source.points[i]);
    part.normals.push_back(source.normals[i]);
  }
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.linear() = rotation_from_vector({0.02, 0.01, -0.02});
  start.translation() = Eigen::Vector3d(0.4, 0.03, -0.03);
  const IcpResult result = refine_icp(grid, part.points, part.normals, start, {});
  const Eigen::Vector3d t = result.T_target_source.translation();
  EXPECT_NEAR(t.x(), 0.4, 0.01);
  EXPECT_NEAR(t.y(), 0.0, 2e-3);
  EXPECT_NEAR(t.z(), 0.0, 4e-3);
  EXPECT_LT(rotation_angle_rad(result.T_target_source.linear()), 1e-3);
  const Eigen::Matrix<double, 6, 6>& A = result.information;
  EXPECT_LT(A(0, 0), 1e-6 * A(1, 1)) << "nothing speaks for a place along the corridor";
}

TEST(RefineIcp, GathersTheInformationItsPairsHold) {
  const Surface room = testing::corner_room(0.05);
  const IcpResult result =
      refine_icp(grid_of(room), room.points, room.normals, Eigen::Isometry3d::Identity(), {});
  const Eigen::Matrix<double, 6, 6>& A = result.information;
  EXPECT_TRUE(A.isApprox(A.transpose(), 1e-9));
  // The trace of the translation block is the sum of the weights, at most one a pair.
  const double pairs = result.paired * static_cast<double>(room.points.size());
  const double weight = A.topLeftCorner<3, 3>().trace();
  EXPECT_GT(weight, 0.9 * pairs);
  EXPECT_LE(weight, pairs * 1.001);
  EXPECT_NEAR(std::sqrt(result.noise_m2), result.rmse_m, 1e-12);
}

TEST(RefineIcp, DoesNotPairSurfacesThatFaceTheOtherWay) {
  const Surface wall = testing::lone_wall(0.05);
  Surface back = wall;
  for (Eigen::Vector3f& n : back.normals) n = -n;
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  start.translation().z() = 0.03;
  const IcpResult result = refine_icp(grid_of(wall), back.points, back.normals, start, {});
  EXPECT_EQ(result.paired, 0.0);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.T_target_source.matrix(), start.matrix());
}

TEST(RefineIcp, ReturnsTheGuessForAnEmptySourceOrOneThatMeetsNothing) {
  const SurfaceGrid grid = grid_of(testing::corner_room(0.1));
  Random random(3);
  const Eigen::Isometry3d start = random_pose(random, 1.0, 2.0);
  const IcpResult empty = refine_icp(grid, {}, {}, start, {});
  EXPECT_EQ(empty.T_target_source.matrix(), start.matrix());
  EXPECT_EQ(empty.paired, 0.0);
  EXPECT_EQ(empty.rmse_m, 0.0);
  EXPECT_FALSE(empty.converged);

  const Surface room = testing::corner_room(0.1);
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 1000.0;
  const IcpResult missed = refine_icp(grid, room.points, room.normals, far, {});
  EXPECT_EQ(missed.T_target_source.matrix(), far.matrix());
  EXPECT_EQ(missed.paired, 0.0);
  EXPECT_TRUE(missed.information.isZero());
}

}  // namespace
}  // namespace landmarkdb
