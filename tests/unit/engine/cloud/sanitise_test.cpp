#include "engine/cloud/sanitise.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/cloud/shapes.hpp"

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
}

TEST(Sanitise, KeepsAFarSurfaceAndDropsWhatIsAloneThere) {
  for (const float away : {150.0F, 1000.0F, 5000.0F}) {  // as far as a long-range scanner sees
    PointCloud cloud = testing::make_room({5, 4, 3}, 0.1F);
    const std::size_t room = cloud.size();
    for (int i = 0; i < 40; ++i) {
      cloud.points.emplace_back(
          away, 0.02F * away * static_cast<float>(i / 8), 0.01F * away * static_cast<float>(i % 8));
    }
    cloud.points.emplace_back(1.0F, away, 2.0F);
    cloud.points.emplace_back(1.0F, 2.0F, -away);
    cloud.points.emplace_back(1.0F, 2.0F, -1.01F * away);
    EXPECT_EQ(sanitise(cloud).out_of_range, 3U) << away;
    EXPECT_EQ(cloud.size(), room + 40U) << away;
  }
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

TEST(BlockSanitiser, CountsEachPointOnceOverAllBlocks) {
  BlockSanitiser sanitiser;
  CloudCounts counts;
  for (int b = 0; b < 3; ++b) {
    PointCloud block = line_of_points(20);
    for (Eigen::Vector3f& p : block.points) p.y() = static_cast<float>(b);
    block.points[2].y() = kNan;
    block.points[6] = block.points[5];
    block.points[7] = {1e7F, 0, 0};
    block.width = 5;
    block.height = 4;
    const CloudCounts part = sanitiser.sanitise(block);
    EXPECT_EQ(part.points, 20U);
    EXPECT_EQ(part.not_finite, 1U);
    EXPECT_EQ(part.duplicates, 1U);
    EXPECT_EQ(part.out_of_range, 1U) << "of block " << b;
    EXPECT_EQ(part.used, 17U);
    EXPECT_EQ(block.size(), 17U);
    EXPECT_EQ(block.width, 0U);
  }
}

TEST(BlockSanitiser, TakesZerosOfBeamsThatMetNothingForNoBulk) {
  PointCloud block;
  block.points.assign(1000, {0, 0, 0});
  for (int i = 1; i <= 200; ++i) block.points.emplace_back(0.0F, 5.0F * static_cast<float>(i), 1);
  const CloudCounts counts = BlockSanitiser().sanitise(block);
  EXPECT_EQ(counts.duplicates, 999U);
  EXPECT_EQ(counts.out_of_range, 0U);
}

TEST(BlockSanitiser, JudgesASmallLastBlockByThoseBefore) {
  BlockSanitiser sanitiser;
  PointCloud first = line_of_points(500);
  sanitiser.sanitise(first);
  PointCloud last;
  last.points = {{3e6F, 0, 0}, {3e6F, 1, 0}, {2, 0, 0}};
  EXPECT_EQ(sanitiser.sanitise(last).out_of_range, 2U);
  ASSERT_EQ(last.size(), 1U);
}

TEST(BlockSanitiser, LeavesBadNormalsForTheEnd) {
  PointCloud block = line_of_points(40);
  block.normals.assign(40, {0, 0, 1.04F});
  for (std::size_t i = 0; i < 10; ++i) block.normals[i] = {kNan, 0, 0};
  BlockSanitiser().sanitise(block);
  ASSERT_EQ(block.normals.size(), 40U);
  EXPECT_TRUE(block.normals[9].isZero());
  EXPECT_EQ(block.normals[10], Eigen::Vector3f(0, 0, 1));
}

}  // namespace
}  // namespace landmarkdb
