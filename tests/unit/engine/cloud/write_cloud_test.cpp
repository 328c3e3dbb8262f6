#include "engine/cloud/write_cloud.hpp"

#include <filesystem>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/cloud/read_cloud.hpp"

namespace landmarkdb {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / ("write_cloud_test_" + name);
}

PointCloud written_and_read(const PointCloud& cloud, const std::string& name) {
  const std::filesystem::path path = temporary(name);
  write_cloud(path, cloud);
  PointCloud again = read_cloud(path, {});
  std::filesystem::remove(path);
  return again;
}

PointCloud full_cloud() {
  PointCloud cloud;
  for (int i = 0; i < 12; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0.5F, -2.0F);
    cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
    cloud.colours.push_back({static_cast<std::uint8_t>(i), 2, 255});
  }
  return cloud;
}

TEST(WriteCloud, IsReadBackAsItWas) {
  for (const char* name : {"a.ply", "a.pcd"}) {
    const PointCloud cloud = full_cloud();
    const PointCloud again = written_and_read(cloud, name);
    EXPECT_EQ(again.points, cloud.points) << name;
    EXPECT_EQ(again.normals, cloud.normals) << name;
    EXPECT_EQ(again.colours, cloud.colours) << name;
    EXPECT_TRUE(again.viewpoints.empty()) << name;
  }
}

TEST(WriteCloud, KeepsAnOriginInDouble) {
  for (const char* name : {"b.ply", "b.pcd"}) {
    PointCloud cloud = full_cloud();
    cloud.origin = {432'100.0, 5'123'500.0, 300.0};
    cloud.points[0] = {0.125F, 0.001F, 0.0F};
    const PointCloud again = written_and_read(cloud, name);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3d before = cloud.origin + cloud.points[i].cast<double>();
      const Eigen::Vector3d after = again.origin + again.points[i].cast<double>();
      EXPECT_LT((before - after).norm(), 1e-4) << name;
    }
  }
}

TEST(WriteCloud, KeepsOneViewpointInBothFormats) {
  for (const char* name : {"c.ply", "c.pcd"}) {
    PointCloud cloud = full_cloud();
    cloud.viewpoints = {{1.0F, 2.0F, 4.0F}};
    const PointCloud again = written_and_read(cloud, name);
    ASSERT_EQ(again.viewpoints.size(), 1U) << name;
    EXPECT_EQ(again.viewpoints[0], cloud.viewpoints[0]) << name;
    EXPECT_EQ(again.points, cloud.points) << name;
  }
}

TEST(WriteCloud, KeepsSeveralViewpointsInPly) {
  PointCloud cloud = full_cloud();
  cloud.viewpoints = {{1, 2, 3}, {4, 5, 6}};
  cloud.viewpoint_index.assign(12, 0);
  cloud.viewpoint_index[7] = 1;
  const PointCloud again = written_and_read(cloud, "d.ply");
  EXPECT_EQ(again.viewpoints, cloud.viewpoints);
  EXPECT_EQ(again.viewpoint_index, cloud.viewpoint_index);
}

TEST(WriteCloud, KeepsRowsAndColumnsInPcd) {
  PointCloud cloud = full_cloud();
  cloud.width = 4;
  cloud.height = 3;
  const PointCloud again = written_and_read(cloud, "e.pcd");
  EXPECT_EQ(again.width, 4U);
  EXPECT_EQ(again.height, 3U);
}

TEST(WriteCloud, SaysWhenThePathCannotBeWritten) {
  try {
    write_cloud("/nonexistent/folder/a.ply", full_cloud());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nonexistent/folder/a.ply"));
  }
}

TEST(WriteCloud, SaysWhenTheDiskIsFull) {
  try {
    write_cloud("/dev/full", full_cloud());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
  }
}

}  // namespace
}  // namespace landmarkdb
