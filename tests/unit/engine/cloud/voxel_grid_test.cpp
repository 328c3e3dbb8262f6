#include "engine/cloud/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

PointCloud random_cloud(std::size_t n) {
  Random random(1);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1, 1));
    cloud.points.emplace_back(p.cast<float>());
  }
  return cloud;
}

TEST(Thin, AveragesWhatLiesInOneVoxel) {
  PointCloud cloud;
  cloud.points = {{0.1F, 0.1F, 0.1F}, {0.3F, 0.5F, 0.1F}, {-0.1F, 0.1F, 0.1F}};
  cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cloud.colours = {{10, 20, 30}, {20, 41, 30}, {1, 2, 3}};
  cloud.viewpoints = {{0, 0, 0}, {1, 1, 1}};
  cloud.viewpoint_index = {1, 0, 0};
  cloud.origin = {100, 200, 300};
  const PointCloud thinned = thin(cloud, 1.0);
  ASSERT_EQ(thinned.size(), 2U);  // ordered by z, y, x: the negative x comes first
  EXPECT_TRUE(thinned.points[1].isApprox(Eigen::Vector3f(0.2F, 0.3F, 0.1F)));
  EXPECT_TRUE(thinned.normals[1].isApprox(Eigen::Vector3f(1, 1, 0).normalized()));
  EXPECT_EQ(thinned.colours[1], (std::array<std::uint8_t, 3>{15, 31, 30}));
  EXPECT_THAT(thinned.viewpoint_index, ::testing::ElementsAre(0, 1));
  EXPECT_EQ(thinned.viewpoints, cloud.viewpoints);
  EXPECT_EQ(thinned.origin, cloud.origin);
}

TEST(Thin, DoesNotDependOnTheOrderOfThePoints) {
  PointCloud cloud = random_cloud(5000);
  const PointCloud first = thin(cloud, 0.25);
  std::reverse(cloud.points.begin(), cloud.points.end());
  const PointCloud second = thin(cloud, 0.25);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_LT(first.size(), cloud.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_TRUE(first.points[i].isApprox(second.points[i], 1e-5F));
  }
}

TEST(Thin, IsNotChangedByAPointFarAway) {
  PointCloud cloud = random_cloud(5000);
  const PointCloud alone = thin(cloud, 0.01);
  // 1e7 m by 1 cm: cell numbers that three times do not fit 64 bits together.
  cloud.points.emplace_back(1e7F, 1e7F, 1e7F);
  cloud.points.emplace_back(-1e7F, -1e7F, -1e7F);
  const PointCloud together = thin(cloud, 0.01);
  ASSERT_EQ(together.size(), alone.size() + 2);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(together.points[i + 1], alone.points[i]);
  }
}

TEST(Thin, LeavesOutWhatIsNotFinite) {
  PointCloud cloud = random_cloud(10);
  cloud.points[3].x() = std::numeric_limits<float>::quiet_NaN();
  cloud.points[4].y() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(thin(cloud, 1e-4).size(), 8U);
  EXPECT_EQ(thin(PointCloud{}, 1.0).size(), 0U);
}

TEST(Thin, RefusesAVoxelThatIsNoLength) {
  const PointCloud cloud = random_cloud(10);
  for (const double voxel_m :
       {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-320, 1e-30}) {
    EXPECT_THROW(thin(cloud, voxel_m), Error) << voxel_m;
  }
}

}  // namespace
}  // namespace landmarkdb
