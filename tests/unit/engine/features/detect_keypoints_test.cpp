#include "engine/features/detect_keypoints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stop_token>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::corner_room;

constexpr double kSpacing = 0.15;

KeypointOptions options_for(KeypointMethod method) {
  return {.method = method, .spacing_m = kSpacing, .structure_radius_m = 0.2};
}

constexpr KeypointMethod kAll[] = {KeypointMethod::kUniform,
                                   KeypointMethod::kStructure,
                                   KeypointMethod::kIss,
                                   KeypointMethod::kNarf};

TEST(DetectKeypoints, GivesAscendingIndicesOfTheCloudByEveryMethod) {
  const PreparedCloud cloud = corner_room(1);
  for (const KeypointMethod method : kAll) {
    const Keypoints found = detect_keypoints(cloud, options_for(method), {});
    EXPECT_GT(found.size(), 0U) << static_cast<int>(method);
    EXPECT_LT(found.size(), cloud.size()) << static_cast<int>(method);
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_LT(found.index[i], cloud.size());
      ASSERT_TRUE(i == 0 || found.index[i - 1] < found.index[i]);
    }
  }
}

TEST(DetectKeypoints, DoesNotDependOnTheThreadCount) {
  const PreparedCloud cloud = corner_room(2);
  RunContext three;
  three.threads = 3;
  for (const KeypointMethod method : kAll) {
    EXPECT_EQ(detect_keypoints(cloud, options_for(method), {}).index,
              detect_keypoints(cloud, options_for(method), three).index);
  }
}

TEST(DetectKeypoints, UniformTakesOnePointAVoxelTheOneNearestItsCentre) {
  const PreparedCloud cloud = corner_room(3);
  const Keypoints found = detect_keypoints(cloud, options_for(KeypointMethod::kUniform), {});
  Eigen::Vector3d min = cloud.points.front().cast<double>();
  for (const auto& p : cloud.points) min = min.cwiseMin(p.cast<double>());
  const auto voxel = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector3d c = (p.cast<double>() - min) / kSpacing;
    return std::tuple(std::floor(c.x()), std::floor(c.y()), std::floor(c.z()));
  };
  const auto from_centre = [&](const Eigen::Vector3f& p) {
    const auto [x, y, z] = voxel(p);
    const Eigen::Vector3d centre = min + kSpacing * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
    return (p.cast<double>() - centre).norm();
  };
  std::set<std::tuple<double, double, double>> all;
  for (const auto& p : cloud.points) all.insert(voxel(p));
  std::set<std::tuple<double, double, double>> taken;
  for (const std::uint32_t index : found.index) taken.insert(voxel(cloud.points[index]));
  EXPECT_EQ(taken, all);
  EXPECT_EQ(found.size(), all.size());
  for (const std::uint32_t index : found.index) {
    for (const auto& p : cloud.points) {
      if (voxel(p) == voxel(cloud.points[index])) {
        ASSERT_LE(from_centre(cloud.points[index]), from_centre(p) + 1e-12);
      }
    }
  }
}

TEST(DetectKeypoints, UniformTakesCloudsTooWideForThirtyTwoBitKeys) {
  PreparedCloud cloud;
  for (const double far : {0.0, 4000.0, 400000.0}) {
    testing::add_point(cloud, {far, far, far}, {0, 0, 1});
    testing::add_point(cloud, {far, far, 0.0}, {0, 0, 1});
  }
  const Keypoints found =
      detect_keypoints(cloud, {.method = KeypointMethod::kUniform, .spacing_m = 0.5}, {});
  EXPECT_EQ(found.size(), 5U);  // the two at zero share a voxel
}

TEST(DetectKeypoints, StructureLeavesFlatWallsOut) {
  const PreparedCloud cloud = corner_room(4);
  const Keypoints uniform = detect_keypoints(cloud, options_for(KeypointMethod::kUniform), {});
  const Keypoints found = detect_keypoints(cloud, options_for(KeypointMethod::kStructure), {});
  EXPECT_TRUE(std::includes(
      uniform.index.begin(), uniform.index.end(), found.index.begin(), found.index.end()));
  EXPECT_LT(2 * found.size(), uniform.size());
  for (const std::uint32_t index : found.index) {
    const Eigen::Vector3f p = cloud.points[index];
    const bool open_wall = p.x() > 0.3F && p.y() > 1.4F && p.z() < 0.1F;  // the floor's far part
    EXPECT_FALSE(open_wall && p.x() < 1.8F) << p.transpose();
  }
}

TEST(DetectKeypoints, IssFindsTheCornersOfABox) {
  PreparedCloud cloud;
  Random random(5);
  constexpr double kResolution = 0.04;
  const Eigen::Vector3d o(0, 0, 0);
  const Eigen::Vector3d x(1, 0, 0);
  const Eigen::Vector3d y(0, 1, 0);
  const Eigen::Vector3d z(0, 0, 1);
  testing::add_plane(cloud, o, x, z, kResolution, random);
  testing::add_plane(cloud, o, y, x, kResolution, random);
  testing::add_plane(cloud, x, y, z, kResolution, random);
  cloud.resolution_m = kResolution;
  const Keypoints found = detect_keypoints(cloud, options_for(KeypointMethod::kIss), {});
  ASSERT_GT(found.size(), 0U);
  EXPECT_LT(found.size(), 60U);
  const Eigen::Vector3f corner(1, 0, 0);
  const bool near_corner = std::any_of(found.index.begin(), found.index.end(), [&](auto index) {
    return (cloud.points[index] - corner).norm() < 0.15F;
  });
  EXPECT_TRUE(near_corner);
}

TEST(DetectKeypoints, AFlatWallHasNoIssAndNoStructureKeypoints) {
  PreparedCloud cloud;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) testing::add_point(cloud, {0.04 * i, 0.04 * j, 3}, {0, 0, -1});
  }
  cloud.resolution_m = 0.04;
  EXPECT_EQ(detect_keypoints(cloud, options_for(KeypointMethod::kIss), {}).size(), 0U);
  EXPECT_EQ(detect_keypoints(cloud, options_for(KeypointMethod::kStructure), {}).size(), 0U);
}

TEST(DetectKeypoints, TakesAnEmptyCloudAndASinglePoint) {
  PreparedCloud cloud;
  cloud.resolution_m = 0.05;
  for (const KeypointMethod method : kAll) {
    EXPECT_EQ(detect_keypoints(cloud, options_for(method), {}).size(), 0U);
  }
  testing::add_point(cloud, {1, 2, 3}, {0, 0, 1});
  for (const KeypointMethod method : kAll) {
    EXPECT_LE(detect_keypoints(cloud, options_for(method), {}).size(), 1U);
  }
}

TEST(DetectKeypoints, RefusesOptionsAndCloudsThatCannotBe) {
  const PreparedCloud good = corner_room(6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 1e-12}) {
    KeypointOptions options = options_for(KeypointMethod::kUniform);
    options.spacing_m = bad;
    EXPECT_THROW(detect_keypoints(good, options, {}), Error) << bad;
    options = options_for(KeypointMethod::kStructure);
    options.structure_radius_m = bad;
    EXPECT_THROW(detect_keypoints(good, options, {}), Error) << bad;
    PreparedCloud cloud = good;
    cloud.resolution_m = bad;
    EXPECT_THROW(detect_keypoints(cloud, options_for(KeypointMethod::kIss), {}), Error) << bad;
    EXPECT_THROW(detect_keypoints(cloud, options_for(KeypointMethod::kNarf), {}), Error) << bad;
  }
  KeypointOptions options = options_for(KeypointMethod::kStructure);
  options.min_structure = nan;
  EXPECT_THROW(detect_keypoints(good, options, {}), Error);
  options.method = static_cast<KeypointMethod>(17);
  EXPECT_THROW(detect_keypoints(good, options, {}), Error);
  for (const KeypointMethod method : kAll) {
    PreparedCloud cloud = good;
    cloud.points[3].x() = static_cast<float>(nan);
    EXPECT_THROW(detect_keypoints(cloud, options_for(method), {}), Error);
    cloud = good;
    cloud.normals.clear();
    EXPECT_THROW(detect_keypoints(cloud, options_for(method), {}), Error);
  }
}

TEST(DetectKeypoints, StopsWhenAsked) {
  const PreparedCloud cloud = corner_room(7);
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  for (const KeypointMethod method : kAll) {
    EXPECT_THROW(detect_keypoints(cloud, options_for(method), context), Error);
  }
}

}  // namespace
}  // namespace landmarkdb
