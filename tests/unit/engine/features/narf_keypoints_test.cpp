#include "engine/features/narf_keypoints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/features/pcl_narf.hpp"
#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::add_point;
using testing::corner_room;

constexpr double kSupport = 0.3;

// An exact laser scan of a box room from zero, the whole sphere, in steps of `step_rad`: what a
// simulated scan looks like, all surfaces exact and some seen exactly edge-on.
PreparedCloud sphere_scan(const Eigen::Vector3d& low,
                          const Eigen::Vector3d& high,
                          double step_rad) {
  PreparedCloud cloud;
  const int rows = static_cast<int>(std::numbers::pi / step_rad);
  for (int row = 0; row <= rows; ++row) {
    const double polar = row * step_rad;
    for (int column = 0; column < 2 * rows; ++column) {
      const double azimuth = column * step_rad;
      const Eigen::Vector3d ray(std::sin(polar) * std::cos(azimuth),
                                std::sin(polar) * std::sin(azimuth),
                                std::cos(polar));
      double range = 1e9;
      Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
      for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(ray[axis]) < 1e-12) continue;
        const double wall = (ray[axis] > 0 ? high : low)[axis] / ray[axis];
        if (wall < range) {
          range = wall;
          normal = -Eigen::Vector3d::Unit(axis) * (ray[axis] > 0 ? 1 : -1);
        }
      }
      add_point(cloud, range * ray, normal);
    }
  }
  cloud.resolution_m = 0.05;
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  return cloud;
}

TEST(NarfKeypoints, SurvivesAWholeSphereScan) {
  const PreparedCloud cloud = sphere_scan({-2, -3, -1}, {2, 3, 1.5}, 0.02);
  const Keypoints found = narf_keypoints(cloud, kSupport, {});
  for (const std::uint32_t index : found.index) EXPECT_LT(index, cloud.size());
}

TEST(NarfKeypoints, FindsTheBallAndTheBoxRatherThanTheOpenWalls) {
  const PreparedCloud cloud = corner_room(1);
  const Keypoints found = narf_keypoints(cloud, kSupport, {});
  ASSERT_GT(found.size(), 3U);
  EXPECT_EQ(found.index, narf_keypoints(cloud, kSupport, {}).index);
}

TEST(NarfKeypoints, SurvivesPlanesSeenExactlyEdgeOn) {
  // A shelf in the sensor's own plane and another that ends in it, above a floor.
  for (const double height : {0.0, 1e-7, -0.2}) {
    PreparedCloud cloud;
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 40; ++j) {
        add_point(cloud, {0.05 * (i - 20), height, 2.0 + 0.05 * j}, {0, 1, 0});
        add_point(cloud, {0.05 * (i - 20), 1.0, 1.0 + 0.05 * j}, {0, -1, 0});
        add_point(cloud, {height, 0.05 * (i - 20), 2.0 + 0.05 * j}, {1, 0, 0});
        add_point(cloud, {0.05 * (i - 20), 0.05 * (j - 20), 5.0}, {0, 0, -1});
      }
    }
    cloud.resolution_m = 0.05;
    narf_keypoints(cloud, kSupport, {});
  }
}

TEST(NarfKeypoints, SurvivesASingleWallALineAndPointsOnTheSensor) {
  PreparedCloud wall;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) add_point(wall, {0.04 * i, 0.04 * j, 3}, {0, 0, -1});
  }
  wall.resolution_m = 0.04;
  narf_keypoints(wall, kSupport, {});
  PreparedCloud line;
  for (int i = 0; i < 100; ++i) add_point(line, {0.02 * i, 0, 1}, {0, 0, -1});
  line.resolution_m = 0.02;
  narf_keypoints(line, kSupport, {});
  PreparedCloud on_sensor;
  for (int i = 0; i < 10; ++i) add_point(on_sensor, {0, 0, 0}, {0, 0, 1});
  on_sensor.resolution_m = 0.05;
  EXPECT_EQ(narf_keypoints(on_sensor, kSupport, {}).size(), 0U);
}

TEST(NarfKeypoints, LeavesOutPointsBeyondAnyRange) {
  PreparedCloud cloud = corner_room(2);
  const std::size_t near = cloud.size();
  for (const double far : {1e7, 1e19, 3e38}) {
    add_point(cloud, {far, 0, 0}, {1, 0, 0});
    add_point(cloud, {0, -far, far}, {1, 0, 0});
  }
  const std::vector<Eigen::Vector3f> found = narf_interest_points(cloud.points, 0.01, kSupport);
  EXPECT_EQ(found,
            narf_interest_points(
                std::span<const Eigen::Vector3f>(cloud.points).first(near), 0.01, kSupport));
  EXPECT_TRUE(narf_interest_points({}, 0.01, kSupport).empty());
}

TEST(NarfKeypoints, FollowsTheAxesWhicheverIsUp) {
  const PreparedCloud cloud = corner_room(3);
  std::vector<Eigen::Vector3f> seen;
  std::vector<Eigen::Vector3f> turned;
  for (const Eigen::Vector3f& p : cloud.points) {
    const Eigen::Vector3f q = p - Eigen::Vector3f(1.3F, 0.9F, 1.6F);
    seen.push_back(q);
    turned.emplace_back(q.y(), q.z(), q.x());
  }
  const std::vector<Eigen::Vector3f> a = narf_interest_points(seen, 0.03, kSupport);
  const std::vector<Eigen::Vector3f> b = narf_interest_points(turned, 0.03, kSupport);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 0U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((Eigen::Vector3f(a[i].y(), a[i].z(), a[i].x()) - b[i]).norm(), 1e-5F);
  }
}

TEST(MendSurfaceChanges, TakesTheScoreOfDirectionsThatAreNoneAndTheDustOffTheRest) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> scores = {1.0F, 0.5F, nan, 0.7F, 1.0F};
  std::vector<Eigen::Vector3f> directions = {
      {nan, 0, 1}, {0, 0.6F, 0.8F}, {1, 0, 0}, {1e-21F, -1e-9F, 1}, {0, -infinity, 0}};
  mend_surface_changes(scores, directions);
  EXPECT_EQ(scores, (std::vector<float>{0.0F, 0.5F, 0.0F, 0.7F, 0.0F}));
  EXPECT_EQ(directions[0], Eigen::Vector3f::Zero());
  EXPECT_EQ(directions[1], Eigen::Vector3f(0, 0.6F, 0.8F));
  EXPECT_EQ(directions[2], Eigen::Vector3f::Zero());
  EXPECT_EQ(directions[3], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(directions[4], Eigen::Vector3f::Zero());
}

TEST(NarfKeypoints, UnitesTheViewpoints) {
  PreparedCloud cloud = corner_room(4);
  const std::size_t first = cloud.size();
  PreparedCloud other = corner_room(5);
  for (std::size_t i = 0; i < other.size(); ++i) {
    add_point(cloud,
              (other.points[i] + Eigen::Vector3f(10, 0, 0)).cast<double>(),
              other.normals[i].cast<double>());
  }
  cloud.viewpoints = {Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(11, 1, 1)};
  cloud.viewpoint_index.assign(cloud.size(), 0);
  for (std::size_t i = first; i < cloud.size(); ++i) cloud.viewpoint_index[i] = 1;
  const Keypoints found = narf_keypoints(cloud, kSupport, {});
  const Keypoints alone = narf_keypoints(corner_room(4), kSupport, {});
  ASSERT_GT(found.size(), alone.size());
  EXPECT_TRUE(std::equal(alone.index.begin(), alone.index.end(), found.index.begin()));
  EXPECT_GE(found.index[alone.size()], first);
  cloud.viewpoint_index.back() = 2;
  EXPECT_THROW(narf_keypoints(cloud, kSupport, {}), Error);
  cloud.viewpoint_index.pop_back();
  EXPECT_THROW(narf_keypoints(cloud, kSupport, {}), Error);
}

}  // namespace
}  // namespace landmarkdb
