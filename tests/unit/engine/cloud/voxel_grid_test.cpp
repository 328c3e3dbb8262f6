#include "engine/cloud/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

TEST(Thin, CountsEachPointByItsWeight) {
  PointCloud cloud;
  cloud.points = {{0.1F, 0, 0}, {0.5F, 0, 0}};
  cloud.normals = {{1, 0, 0}, {0, 1, 0}};
  cloud.colours = {{10, 0, 0}, {50, 0, 0}};
  cloud.weights = {3, 1};
  const PointCloud thinned = thin(cloud, 1.0);
  ASSERT_EQ(thinned.size(), 1U);
  EXPECT_FLOAT_EQ(thinned.points[0].x(), 0.2F);
  EXPECT_TRUE(thinned.normals[0].isApprox(Eigen::Vector3f(3, 1, 0).normalized()));
  EXPECT_EQ(thinned.colours[0][0], 20);
  EXPECT_TRUE(thinned.weights.empty());
}

PointCloud seen_cloud(std::size_t n) {
  PointCloud cloud = random_cloud(n);
  for (std::size_t i = 0; i < n; ++i) {
    cloud.normals.push_back(Eigen::Vector3f(1, static_cast<float>(i % 3), 0).normalized());
    cloud.viewpoint_index.push_back(static_cast<std::uint16_t>(i % 5));
  }
  cloud.viewpoints.assign(5, Eigen::Vector3f::Zero());
  return cloud;
}

TEST(Condense, ChangesNothingThatThinningToVoxelsOfWholeCellsGives) {
  const PointCloud cloud = seen_cloud(20'000);
  const PointCloud direct = thin(cloud, 0.5);
  PointCloud condensed = cloud;
  for (const double cell_m : {0.0625, 0.125, 0.25}) condense(condensed, cell_m);
  EXPECT_LT(condensed.size(), cloud.size() / 2);
  EXPECT_EQ(std::accumulate(condensed.weights.begin(), condensed.weights.end(), std::size_t{0}),
            cloud.size());
  const PointCloud thinned = thin(condensed, 0.5);
  ASSERT_EQ(thinned.size(), direct.size());
  EXPECT_EQ(thinned.viewpoint_index, direct.viewpoint_index) << "of the first point, still";
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    ASSERT_LT((thinned.points[i] - direct.points[i]).norm(), 1e-6F);
    ASSERT_GT(thinned.normals[i].dot(direct.normals[i]), 0.99F);
  }
}

TEST(Condense, KeepsTheOrderInWhichCellsAppear) {
  PointCloud cloud;
  cloud.points = {{5.5F, 0, 0}, {0.2F, 0, 0}, {9.5F, 0, 0}, {5.7F, 0, 0}};
  condense(cloud, 1.0);
  ASSERT_EQ(cloud.size(), 3U);
  EXPECT_FLOAT_EQ(cloud.points[0].x(), 5.6F);
  EXPECT_FLOAT_EQ(cloud.points[1].x(), 0.2F);
  EXPECT_THAT(cloud.weights, ::testing::ElementsAre(2, 1, 1));
}

RunContext on_threads(int threads) {
  RunContext context;
  context.threads = threads;
  return context;
}

TEST(Condense, GivesTheSameOnAnyNumberOfThreads) {
  PointCloud one = seen_cloud(200'000);
  PointCloud three = one;
  condense(one, 0.03, on_threads(1));
  condense(three, 0.03, on_threads(3));
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.normals, three.normals);
  EXPECT_EQ(one.weights, three.weights);
}

// Cell numbers and a point's index together are beyond 64 bits, the cell numbers alone are not.
TEST(Thin, IsTheSameWhereKeysAreSortedApartFromIndices) {
  PointCloud cloud = random_cloud(5000);
  const PointCloud alone = thin(cloud, 0.01);
  cloud.points.emplace_back(8000.0F, 8000.0F, 8000.0F);
  cloud.points.emplace_back(-8000.0F, -8000.0F, -8000.0F);
  const PointCloud wide = thin(cloud, 0.01);
  ASSERT_EQ(wide.size(), alone.size() + 2);
  EXPECT_TRUE(std::equal(alone.points.begin(), alone.points.end(), wide.points.begin() + 1));
}

}  // namespace
}  // namespace landmarkdb
