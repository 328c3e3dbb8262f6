#include "engine/registration/verify.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::Surface;

constexpr double kCell_m = 0.05;

SurfaceGrid grid_of(const Surface& surface) {
  return SurfaceGrid(surface.points, surface.normals, kCell_m, 2);
}

Evidence overlap_of(const SurfaceGrid& grid,
                    const Surface& source,
                    const Eigen::Isometry3d& T = Eigen::Isometry3d::Identity()) {
  Evidence evidence;
  measure_overlap(grid, source.points, source.normals, T, nullptr, {}, evidence);
  return evidence;
}

double observability_of(const Surface& surface) {
  const IcpResult icp = refine_icp(
      grid_of(surface), surface.points, surface.normals, Eigen::Isometry3d::Identity(), {});
  double squares = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto n = static_cast<double>(surface.points.size());
  for (const Eigen::Vector3f& p : surface.points) mean += p.cast<double>() / n;
  for (const Eigen::Vector3f& p : surface.points) {
    squares += (p.cast<double>() - mean).squaredNorm() / n;
  }
  return observability(icp, std::sqrt(squares), surface.points.size());
}

TEST(MeasureOverlap, IsWholeForTheSurfaceItself) {
  const Surface room = testing::corner_room(0.04);
  const Evidence evidence = overlap_of(grid_of(room), testing::corner_room(0.05, 2));
  EXPECT_GT(evidence.overlap, 0.97);
  EXPECT_GT(evidence.balanced, 0.95);
  EXPECT_LT(evidence.rmse_m, 0.005);
  EXPECT_NEAR(evidence.strength.sum(), 1.0, 1e-6);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(evidence.strength[axis], 0.2);
}

TEST(MeasureOverlap, IsTheShareThatLiesOnTheSurface) {
  const Surface room = testing::corner_room(0.04);
  Surface half = testing::corner_room(0.05, 2);
  for (std::size_t i = 0; i < half.points.size(); i += 2)
    half.points[i] += Eigen::Vector3f(50, 0, 0);
  EXPECT_NEAR(overlap_of(grid_of(room), half).overlap, 0.5, 0.02);
}

TEST(MeasureOverlap, AsksForNormalsThatAgreeAndForLittleDistance) {
  const Surface wall = testing::lone_wall(0.04);
  Surface turned = wall;
  for (Eigen::Vector3f& n : turned.normals) n = -n;
  EXPECT_EQ(overlap_of(grid_of(wall), turned).overlap, 0.0);
  Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
  off.translation().z() = 0.6 * kCell_m;
  const Evidence inside = overlap_of(grid_of(wall), wall, off);
  EXPECT_GT(inside.overlap, 0.99);
  EXPECT_NEAR(inside.rmse_m, 0.6 * kCell_m, 1e-6);
  off.translation().z() = 0.9 * kCell_m;
  EXPECT_EQ(overlap_of(grid_of(wall), wall, off).overlap, 0.0);
}

TEST(MeasureOverlap, WeighsEachDirectionAlikeInTheBalance) {
  // A large wall that fits, a small one across it that does not.
  const Surface wall = testing::lone_wall(0.04);
  Surface source = wall;
  Random random(1);
  source.add({0, 0, 1.0}, {0, 0.8, 0}, {0, 0, 0.8}, 0.04, random);
  const Evidence evidence = overlap_of(grid_of(wall), source);
  EXPECT_GT(evidence.overlap, 0.9);
  EXPECT_NEAR(evidence.balanced, 0.5, 0.02);
}

TEST(MeasureOverlap, FollowsThePose) {
  const Surface room = testing::corner_room(0.04);
  Random random(4);
  const Eigen::Isometry3d T = testing::random_pose(random, 3.0, 20.0);
  const Evidence evidence = overlap_of(grid_of(room), room.seen_from(T), T);
  EXPECT_GT(evidence.overlap, 0.97);  // at the edges a point may meet the other side's normal
  EXPECT_LT(overlap_of(grid_of(room), room, T).overlap, 0.5);
}

TEST(MeasureOverlap, CountsWhatLiesWhereTheScannerLookedThrough) {
  const Surface room = testing::corner_room(0.02);
  const SurfaceGrid grid = grid_of(room);
  const ScannedSpace scanned(
      room.points, std::vector<Eigen::Vector3f>{{1.5F, 1.5F, 1.2F}}, {}, grid);
  Surface source = room;
  Random random(3);
  source.add({0.5, 0.5, 1.0}, {0.4, 0, 0}, {0, 0.4, 0}, 0.02, random);
  source.add({-4, 0.5, 1.0}, {0.4, 0, 0}, {0, 0.4, 0}, 0.02, random);
  const double added = 400.0 / static_cast<double>(source.points.size());
  Evidence evidence;
  measure_overlap(
      grid, source.points, source.normals, Eigen::Isometry3d::Identity(), &scanned, {}, evidence);
  EXPECT_NEAR(evidence.refuted, added, 0.1 * added) << "what is behind the walls is not known";
  measure_overlap(
      grid, source.points, source.normals, Eigen::Isometry3d::Identity(), nullptr, {}, evidence);
  EXPECT_EQ(evidence.refuted, 0.0);
}

TEST(MeasureOverlap, SaysNothingForNothing) {
  const Evidence evidence = overlap_of(grid_of(testing::lone_wall(0.1)), Surface{});
  EXPECT_EQ(evidence.overlap, 0.0);
  EXPECT_EQ(evidence.balanced, 0.0);
  EXPECT_EQ(evidence.rmse_m, 0.0);
}

TEST(Observability, IsNothingForAPlaneAndACorridorAndPlentyForACorner) {
  EXPECT_LT(observability_of(testing::lone_wall(0.05)), 1e-4);
  EXPECT_LT(observability_of(testing::corridor(0.08)), 1e-4);
  const double corner = observability_of(testing::corner_room(0.05));
  EXPECT_GT(corner, 0.05);
  EXPECT_LE(corner, 1.0);
}

TEST(Observability, DoesNotDependOnScaleOrDensity) {
  const double fine = observability_of(testing::corner_room(0.05));
  EXPECT_NEAR(observability_of(testing::corner_room(0.08)), fine, 0.1 * fine);
  Surface doubled = testing::corner_room(0.05);
  for (Eigen::Vector3f& p : doubled.points) p *= 2.0F;
  const SurfaceGrid grid(doubled.points, doubled.normals, 2.0 * kCell_m, 2);
  const IcpResult icp =
      refine_icp(grid, doubled.points, doubled.normals, Eigen::Isometry3d::Identity(), {});
  const Surface single = testing::corner_room(0.05);
  const SurfaceGrid single_grid = grid_of(single);
  const IcpResult single_icp =
      refine_icp(single_grid, single.points, single.normals, Eigen::Isometry3d::Identity(), {});
  EXPECT_NEAR(observability(icp, 2.6, doubled.points.size()),
              observability(single_icp, 1.3, single.points.size()),
              0.01);
}

TEST(Observability, IsNothingWithoutPoints) {
  EXPECT_EQ(observability(IcpResult{}, 1.0, 0), 0.0);
  EXPECT_EQ(observability(IcpResult{}, 0.0, 10), 0.0);
  EXPECT_EQ(observability(IcpResult{}, std::nan(""), 10), 0.0);
  EXPECT_EQ(observability(IcpResult{}, 1.0, 10), 0.0);
}

TEST(MeasureSight, LetsClutterStandBeforeAnObject) {
  std::vector<Eigen::Vector3f> seen, behind;
  for (int i = -100; i <= 100; ++i) {
    for (int j = -100; j <= 100; ++j) {
      seen.emplace_back(0.01F * static_cast<float>(i), 0.01F * static_cast<float>(j), 2.0F);
      behind.emplace_back(1.5F * seen.back());
    }
  }
  const std::vector<RangeImage> ranges{RangeImage(seen, Eigen::Vector3f::Zero(), 0.0175)};
  Evidence evidence;
  VerifyOptions options;
  measure_sight(ranges, {behind}, Eigen::Isometry3d::Identity(), kCell_m, options, evidence);
  EXPECT_GT(evidence.contradicted, 0.95);
  options.hidden_contradicts = false;
  measure_sight(ranges, {behind}, Eigen::Isometry3d::Identity(), kCell_m, options, evidence);
  EXPECT_EQ(evidence.contradicted, 0.0);
}

TEST(MeasureSight, TurnsCountsIntoShares) {
  // A wall at 2 m; the entry has its left half right, and a screen before the right half's middle.
  std::vector<Eigen::Vector3f> seen, entry;
  for (int i = -100; i <= 100; ++i) {
    for (int j = -100; j <= 100; ++j) {
      seen.emplace_back(0.01F * static_cast<float>(i), 0.01F * static_cast<float>(j), 2.0F);
      if (i < 0) entry.push_back(seen.back());
      if (i > 0) entry.emplace_back(0.5F * seen.back());
    }
  }
  const std::vector<RangeImage> ranges{RangeImage(seen, Eigen::Vector3f::Zero(), 0.0175)};
  Evidence evidence;
  measure_sight(ranges, {entry}, Eigen::Isometry3d::Identity(), kCell_m, {}, evidence);
  EXPECT_NEAR(evidence.explained, 0.5, 0.06);
  EXPECT_NEAR(evidence.crossed, 0.5, 0.06);
  EXPECT_GT(evidence.coverage, 0.97);
  const double half_right = evidence.explained;
  measure_sight(ranges, SightSurface{}, Eigen::Isometry3d::Identity(), kCell_m, {}, evidence);
  EXPECT_LE(evidence.explained, 0.5) << "nothing seen is nothing proved";
  EXPECT_EQ(evidence.crossed, 0.0);
  EXPECT_EQ(evidence.coverage, 0.0);
  measure_sight(ranges, {seen}, Eigen::Isometry3d::Identity(), kCell_m, {}, evidence);
  EXPECT_GT(evidence.explained, 0.95);
  EXPECT_GT(evidence.explained, half_right);
}

}  // namespace
}  // namespace landmarkdb
