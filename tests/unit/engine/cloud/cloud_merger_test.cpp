#include "engine/cloud/cloud_merger.hpp"

#include <array>
#include <numbers>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/cloud/merge_clouds.hpp"

namespace landmarkdb {
namespace {

PointCloud scan(float z, std::size_t viewpoints) {
  PointCloud cloud;
  for (int i = 0; i < 30; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 1.0F, z);
    cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
    cloud.colours.push_back({static_cast<std::uint8_t>(i), 2, 3});
    if (viewpoints > 1) {
      cloud.viewpoint_index.push_back(static_cast<std::uint16_t>(i % static_cast<int>(viewpoints)));
    }
  }
  for (std::size_t v = 0; v < viewpoints; ++v) {
    cloud.viewpoints.emplace_back(static_cast<float>(v), 0.0F, z);
  }
  cloud.origin = {432'000, 5'123'000, 100};
  return cloud;
}

template <typename T>
std::vector<T> part(const std::vector<T>& values, std::ptrdiff_t begin, std::ptrdiff_t end) {
  return values.empty() ? values : std::vector<T>(values.begin() + begin, values.begin() + end);
}

PointCloud part(const PointCloud& cloud, std::ptrdiff_t begin, std::ptrdiff_t end) {
  PointCloud block = cloud;
  block.points = part(cloud.points, begin, end);
  block.normals = part(cloud.normals, begin, end);
  block.colours = part(cloud.colours, begin, end);
  block.viewpoint_index = part(cloud.viewpoint_index, begin, end);
  return block;
}

Eigen::Isometry3d turned() {
  Eigen::Isometry3d T(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()));
  T.translation() = Eigen::Vector3d(10, 20, 30);
  return T;
}

TEST(CloudMerger, MakesOfBlocksWhatWholeCloudsMake) {
  const std::array clouds{scan(0, 2), scan(5, 1), scan(7, 3)};
  const std::array poses{turned(), turned(), turned()};
  const PointCloud whole = merge_clouds(clouds, poses);
  CloudMerger merger;
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    merger.begin_scan(poses[c]);
    for (std::ptrdiff_t at = 0; at < 30; at += 10) {
      merger.append(part(clouds[c], at, at + 10));
      merger.append(part(clouds[c], 0, 0));
    }
  }
  const PointCloud merged = merger.finish();
  ASSERT_EQ(merged.size(), 90U);
  EXPECT_TRUE((merged.points[0].cast<double>() + merged.origin)
                  .isApprox(whole.points[0].cast<double>() + whole.origin, 1e-9));
  EXPECT_EQ(merged.normals, whole.normals);
  EXPECT_EQ(merged.colours, whole.colours);
  EXPECT_EQ(merged.viewpoint_index, whole.viewpoint_index);
  EXPECT_EQ(merged.viewpoints.size(), 6U);
  EXPECT_EQ(merged.viewpoint_index[30], 2);
  EXPECT_EQ(merged.viewpoint_index[61], 4);
}

TEST(CloudMerger, DropsWhatALaterBlockLacks) {
  CloudMerger merger;
  merger.begin_scan(turned());
  merger.append(scan(0, 1));
  PointCloud bare = scan(1, 0);
  bare.normals.clear();
  bare.colours.clear();
  merger.append(bare);
  merger.append(scan(2, 1));
  const PointCloud merged = merger.finish();
  EXPECT_EQ(merged.size(), 90U);
  EXPECT_TRUE(merged.normals.empty());
  EXPECT_TRUE(merged.colours.empty());
  EXPECT_TRUE(merged.viewpoints.empty());
  EXPECT_TRUE(merged.viewpoint_index.empty());
}

TEST(CloudMerger, CountsNewPointsOnceWhereOthersWereCondensed) {
  CloudMerger merger;
  merger.begin_scan(turned());
  merger.append(scan(0, 1));
  merger.cloud().weights.assign(30, 7);
  merger.append(scan(1, 1));
  const PointCloud merged = merger.finish();
  EXPECT_EQ(merged.weights.front(), 7U);
  EXPECT_EQ(merged.weights.back(), 1U);
  EXPECT_EQ(merged.weights.size(), merged.size());
}

// Two scans of 40,000 viewpoints each: more together than 16 bits count.
CloudMerger with_too_many_viewpoints() {
  PointCloud cloud = scan(0.0F, 1);
  cloud.viewpoint_index.assign(cloud.size(), 39'999);
  cloud.viewpoints.assign(40'000, Eigen::Vector3f::Zero());
  CloudMerger merger;
  for (int k = 0; k < 2; ++k) {
    merger.begin_scan(Eigen::Isometry3d::Identity());
    merger.append(cloud);
    merger.append(cloud);  // a block of the same scan has the same viewpoints
  }
  return merger;
}

TEST(CloudMerger, RefusesMoreViewpointsThanSixteenBitsCount) {
  CloudMerger merger = with_too_many_viewpoints();
  try {
    merger.finish();
    FAIL() << "took 80,000 viewpoints";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("80000 viewpoints"));
  }
}

TEST(CloudMerger, DropsTooManyViewpointsWhereSomePointsHaveNone) {
  CloudMerger merger = with_too_many_viewpoints();
  merger.begin_scan(Eigen::Isometry3d::Identity());
  merger.append(scan(1.0F, 0));
  const PointCloud merged = merger.finish();
  EXPECT_EQ(merged.size(), 5 * scan(0.0F, 1).size());
  EXPECT_TRUE(merged.viewpoints.empty());
  EXPECT_TRUE(merged.viewpoint_index.empty());
}

}  // namespace
}  // namespace landmarkdb
