#include "engine/cloud/strays.hpp"

#include <gtest/gtest.h>

#include "tests/unit/engine/cloud/shapes.hpp"

namespace landmarkdb {
namespace {

constexpr double kRadius_m = 0.25;

TEST(DropStrays, DropsWhatHangsAloneInTheAirAndKeepsTheRestInOrder) {
  const PointCloud room = testing::make_room({5, 4, 3}, 0.1F);
  PointCloud cloud = room;
  cloud.points.insert(cloud.points.begin() + 7, Eigen::Vector3f(2.5F, 2, 1.5F));
  cloud.points.emplace_back(1, 2, 1);
  cloud.viewpoints = {{1, 1, 1}, {2, 2, 1}};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.viewpoint_index.push_back(i == 7 ? 1 : 0);
  }
  EXPECT_EQ(drop_strays(cloud, kRadius_m, {}), 2U);
  EXPECT_EQ(cloud.points, room.points);
  EXPECT_EQ(cloud.viewpoint_index, std::vector<std::uint16_t>(room.size(), 0));
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_EQ(drop_strays(cloud, kRadius_m, {}), 0U);
}

TEST(DropStrays, KeepsAPairAndWhatStandsInTheNextCell) {
  PointCloud cloud = testing::make_room({5, 4, 3}, 0.1F);
  const std::size_t all = cloud.size() + 2;
  cloud.points.emplace_back(2.49F, 2, 1.5F);  // a cell ends at 2.5
  cloud.points.emplace_back(2.51F, 2, 1.5F);
  EXPECT_EQ(drop_strays(cloud, kRadius_m, {}), 0U);
  EXPECT_EQ(cloud.size(), all);
}

TEST(DropStrays, KeepsASparseCloudWhole) {
  PointCloud cloud = testing::make_room({5, 4, 3}, 0.5F);
  const std::size_t all = cloud.size();
  EXPECT_EQ(drop_strays(cloud, kRadius_m, {}), 0U);
  EXPECT_EQ(cloud.size(), all);
  PointCloud none;
  EXPECT_EQ(drop_strays(none, kRadius_m, {}), 0U);
}

}  // namespace
}  // namespace landmarkdb
