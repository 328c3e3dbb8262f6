#include "engine/cloud/sanitise.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

PointCloud line_of_points(int n) {
  PointCloud cloud;
  for (int i = 0; i < n; ++i) cloud.points.emplace_back(static_cast<float>(i), 1.0F, 2.0F);
  return cloud;
}

TEST(Sanitise, CountsWhatItDrops) {
  PointCloud cloud = line_of_points(20);
  cloud.width = 5;
  cloud.height = 4;
  cloud.points[2].y() = kNan;
  cloud.points[3].z() = kInf;
  cloud.points[4].x() = -kInf;
  cloud.points[6] = cloud.points[5];
  cloud.points[7] = {1e7F, 0, 0};
  for (int i = 0; i < 20; ++i) {
    cloud.colours.push_back({static_cast<std::uint8_t>(i), 0, 0});
  }
  const CloudCounts counts = sanitise(cloud);
  EXPECT_EQ(counts.points, 20U);
  EXPECT_EQ(counts.not_finite, 3U);
  EXPECT_EQ(counts.duplicates, 1U);
  EXPECT_EQ(counts.out_of_range, 1U);
  EXPECT_EQ(counts.used, 15U);
  EXPECT_EQ(counts.invalid(), 5U);
  ASSERT_EQ(cloud.size(), 15U);
  EXPECT_EQ(cloud.colours[2][0], 5) << "colours stay with their points";
  EXPECT_EQ(cloud.points[2].x(), 5.0F) << "the order is kept";
  EXPECT_EQ(cloud.width, 0U);
}

TEST(Sanitise, TakesZeroAndMinusZeroForOnePlace) {
  PointCloud cloud;
  cloud.points = {{0.0F, 1, 2}, {-0.0F, 1, 2}};
  EXPECT_EQ(sanitise(cloud).duplicates, 1U);
}

TEST(Sanitise, KeepsAWideCloudWhole) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.points.emplace_back(5000.0F * static_cast<float>(i), 0, 0);
  EXPECT_EQ(sanitise(cloud).used, 100U);
}

// Further out than grids of voxels reach: one such point must not cost the rest.
TEST(Sanitise, DropsALonePointFarOutsideOfARoom) {
  for (const float away : {9e4F, 3e5F, 1e7F}) {
    PointCloud cloud = line_of_points(20);
    cloud.points.emplace_back(away, 1.0F, 2.0F);
    EXPECT_EQ(sanitise(cloud).out_of_range, 1U) << away;
    EXPECT_EQ(cloud.size(), 20U);
  }
  PointCloud cloud = line_of_points(20);
  cloud.points.emplace_back(5000.0F, 1.0F, 2.0F);  // as far as a long-range scanner sees
  EXPECT_EQ(sanitise(cloud).used, 21U);
}

TEST(Sanitise, SurvivesACloudWithNothingInIt) {
  PointCloud cloud;
  EXPECT_EQ(sanitise(cloud).used, 0U);
  cloud.points.assign(10, {kNan, kNan, kNan});
  EXPECT_EQ(sanitise(cloud).not_finite, 10U);
  EXPECT_TRUE(cloud.empty());
}

TEST(Sanitise, MakesNormalsUnitAndRepairsAFew) {
  PointCloud cloud = line_of_points(40);
  cloud.normals.assign(40, {0, 0, 1.04F});
  cloud.normals[10] = {0, 1, 0};
  cloud.normals[11] = {kNan, 0, 0};
  sanitise(cloud);
  ASSERT_EQ(cloud.normals.size(), 40U);
  EXPECT_EQ(cloud.normals[0], Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(cloud.normals[11], Eigen::Vector3f(0, 1, 0)) << "that of the nearest, lower index";
}

TEST(Sanitise, DropsNormalsThatAreMostlyBroken) {
  PointCloud cloud = line_of_points(40);
  cloud.normals.assign(40, {0, 0, 1});
  for (std::size_t i = 0; i < 10; ++i) cloud.normals[i].setZero();
  sanitise(cloud);
  EXPECT_TRUE(cloud.normals.empty());
}

TEST(Sanitise, DropsViewpointsThatCannotBeUsed) {
  PointCloud cloud = line_of_points(3);
  cloud.viewpoints = {{0, 0, 0}};
  cloud.viewpoint_index = {0, 1, 0};
  sanitise(cloud);
  EXPECT_TRUE(cloud.viewpoints.empty());
  EXPECT_TRUE(cloud.viewpoint_index.empty());
}

TEST(Sanitise, RefusesArraysOfDifferentLengths) {
  PointCloud cloud = line_of_points(3);
  cloud.normals.resize(2);
  EXPECT_THROW(sanitise(cloud), Error);
}

}  // namespace
}  // namespace landmarkdb
