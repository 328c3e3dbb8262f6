#include "engine/cloud/join_clouds.hpp"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

QueryCloud cloud_at(std::vector<Eigen::Vector3f> points, const Eigen::Vector3d& t) {
  QueryCloud one;
  one.cloud.points = std::move(points);
  one.T_query_cloud = Eigen::Translation3d(t);
  return one;
}

TEST(JoinClouds, LaysCloudsIntoTheFrameOfTheirPoses) {
  QueryCloud first = cloud_at({{1, 0, 0}, {kNaN, 0, 0}, {1, 1, 0}}, {0, 0, 0});
  QueryCloud second = cloud_at({{1, 0, 0}, {2, 0, 0}}, {0, 0, 5});
  second.T_query_cloud.linear() =
      rotation_from_vector(Eigen::Vector3d::UnitZ() * std::numbers::pi / 2);
  CloudCounts counts;
  const PointCloud joined = join_clouds({first, second}, counts);
  ASSERT_EQ(joined.size(), 4U);
  EXPECT_LT((joined.points[2] - Eigen::Vector3f(0, 1, 5)).norm(), 1e-6F);
  EXPECT_EQ(counts.points, 5U);
  EXPECT_EQ(counts.not_finite, 1U);
  EXPECT_EQ(counts.used, 4U);
}

TEST(JoinClouds, KeepsWhereEachPointWasSeenFrom) {
  QueryCloud first = cloud_at({{1, 0, 0}, {1, 1, 0}}, {0, 0, 0});
  QueryCloud second = cloud_at({{1, 0, 0}}, {0, 0, 5});
  first.cloud.viewpoints = {{9, 9, 9}};
  CloudCounts counts;
  const PointCloud joined = join_clouds({first, second}, counts);
  ASSERT_EQ(joined.viewpoints.size(), 2U);
  EXPECT_EQ(joined.viewpoints[0], Eigen::Vector3f(9, 9, 9));
  EXPECT_EQ(joined.viewpoints[1], Eigen::Vector3f(0, 0, 5));  // its own zero
  EXPECT_EQ(joined.viewpoint_index, (std::vector<std::uint16_t>{0, 0, 1}));
}

TEST(JoinClouds, LeavesALoneCloudInItsOwnFrameAndOrigin) {
  QueryCloud one = cloud_at({{1, 0, 0}, {2, 0, 0}}, {0, 0, 0});
  one.cloud.origin = {500'000.0, 5'400'000.0, 0.0};
  CloudCounts counts;
  const PointCloud joined = join_clouds({one}, counts);
  EXPECT_EQ(joined.origin, one.cloud.origin);
  EXPECT_EQ(joined.points, one.cloud.points);
  EXPECT_TRUE(joined.viewpoint_index.empty());
}

TEST(JoinClouds, CountsWhatTwoCloudsHaveToTheBitOnce) {
  const QueryCloud one = cloud_at({{1, 0, 0}, {2, 0, 0}}, {0, 0, 0});
  CloudCounts counts;
  EXPECT_EQ(join_clouds({one, one}, counts).size(), 2U);
  EXPECT_EQ(counts.points, 4U);
  EXPECT_EQ(counts.duplicates, 2U);
  EXPECT_EQ(counts.used, 2U);
}

TEST(JoinClouds, RefusesNoneAndTooMany) {
  CloudCounts counts;
  EXPECT_THROW(join_clouds({}, counts), Error);
  EXPECT_THROW(join_clouds(std::vector<QueryCloud>(kMostQueryClouds + 1), counts), Error);
}

}  // namespace
}  // namespace landmarkdb
