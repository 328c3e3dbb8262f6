#include "engine/retrieval/query_view.hpp"

#include <algorithm>
#include <limits>
#include <stop_token>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/retrieval/feature_options.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

const FeatureOptions kOptions =
    derive_feature_options({8.0, 0.01}, EntryKind::kPlace, KeypointMethod::kStructure, 0.05);

TEST(CleanQuery, CountsWhatItDropsAndLooksFromZero) {
  PointCloud cloud;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 10; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), static_cast<float>(i * i), 2.0F);
  }
  cloud.points.emplace_back(nan, 0.0F, 0.0F);
  cloud.points.push_back(cloud.points[0]);
  const CleanQuery query = clean_query(cloud);
  EXPECT_EQ(query.counts.points, 12U);
  EXPECT_EQ(query.counts.used, 10U);
  EXPECT_EQ(query.counts.not_finite, 1U);
  EXPECT_EQ(query.counts.duplicates, 1U);
  ASSERT_EQ(query.cloud.viewpoints.size(), 1U);
  EXPECT_TRUE(query.cloud.viewpoints[0].isZero());
  EXPECT_TRUE(query.centre.isApprox(Eigen::Vector3d(4.5, 28.5, 2.0), 1e-6));
  EXPECT_GT(query.scale.spacing_m, 0.0);
}

TEST(CleanQuery, LooksFromTheViewpointTheCloudHas) {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  cloud.viewpoints = {{5, 6, 7}};
  EXPECT_EQ(clean_query(cloud).cloud.viewpoints[0], Eigen::Vector3f(5, 6, 7));
  cloud.viewpoints = {};
  cloud.origin = Eigen::Vector3d(10, 20, 30);  // the sensor frame's zero lies on the other side
  EXPECT_EQ(clean_query(cloud).cloud.viewpoints[0], Eigen::Vector3f(-10, -20, -30));
}

TEST(CleanQuery, TakesAnEmptyCloud) {
  const CleanQuery query = clean_query(PointCloud{});
  EXPECT_EQ(query.cloud.size(), 0U);
  EXPECT_EQ(query.scale.spacing_m, 0.0);
  EXPECT_TRUE(query.centre.isZero());
}

TEST(DensePart, KeepsWhatIsDenseEnoughWithItsEdgesAndNothingFarFromIt) {
  // A patch of points a centimetre apart, and another 40 cm apart three metres away.
  PointCloud cloud;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const auto x = static_cast<float>(i);
      const auto y = static_cast<float>(j);
      cloud.points.emplace_back(0.01F * x, 0.01F * y, 1.0F);
      cloud.normals.emplace_back(0.0F, 0.0F, -1.0F);
      if (i % 4 == 0 && j % 4 == 0) {
        cloud.points.emplace_back(3.0F + 0.1F * x, 0.1F * y, 1.0F);
        cloud.normals.emplace_back(0.0F, 0.0F, -1.0F);
      }
    }
  }
  const CleanQuery query = clean_query(cloud);
  const CleanQuery dense = dense_part(query, 0.015, {});
  EXPECT_EQ(dense.cloud.size(), 1600U);
  EXPECT_EQ(dense.cloud.normals.size(), query.cloud.normals.empty() ? 0U : 1600U);
  EXPECT_LT(dense.cloud.points.back().x(), 1.0F);
  EXPECT_EQ(dense_part(query, 0.5, {}).cloud.size(), query.cloud.size());
  EXPECT_EQ(dense_part(query, 0.001, {}).cloud.size(), 0U);
}

TEST(ViewQuery, DescribesTheCloudAtTheResolutionAsked) {
  const testing::SyntheticScene room = testing::small_room(2);
  const CleanQuery query = clean_query(testing::frame_in(room, 1).cloud);
  StageTimings timings;
  const QueryView view = view_query(query, kOptions, 1, {}, timings);
  EXPECT_EQ(view.prepared.resolution_m, 0.05);
  EXPECT_TRUE(view.prepared.normals_from_viewpoint);
  EXPECT_GT(view.descriptors.size(), 50U);
  EXPECT_EQ(view.test.size(), 512U);
  EXPECT_EQ(view.sample_points.size(), std::min<std::size_t>(view.prepared.size(), 4000));
  EXPECT_EQ(view.sample_normals.size(), view.sample_points.size());
  EXPECT_GT(view.precise_points.size(), 1000U);
  EXPECT_EQ(view.precise_normals.size(), view.precise_points.size());
  // Turned to the sensor: what it saw faces it.
  for (std::size_t i = 0; i < view.sample_points.size(); ++i) {
    ASSERT_LE(view.sample_normals[i].dot(view.sample_points[i]), 1e-4F);
  }
  EXPECT_GT(timings.preprocess.count(), 0.0);
  EXPECT_GT(timings.describe.count(), 0.0);
}

TEST(ViewForObjects, LeavesOutWhatPlacesAloneAreAskedFor) {
  const testing::SyntheticScene room = testing::small_room(2);
  const CleanQuery query = clean_query(testing::frame_in(room, 1).cloud);
  StageTimings timings;
  const QueryView view = view_for_objects(query, kOptions, {}, timings);
  EXPECT_GT(view.descriptors.size(), 50U);
  EXPECT_FALSE(view.noise.sigma_m.empty());
  EXPECT_EQ(view.test.size(), 0U);
  EXPECT_TRUE(view.planes.empty());
}

TEST(ViewQuery, RefusesACloudTooSmallOrTooThinForTheResolution) {
  PointCloud speck, line;
  for (int i = 0; i < 100; ++i) {
    const auto a = static_cast<float>(i);
    speck.points.emplace_back(1e-4F * a, 1e-6F * a * a, 1.0F);
    line.points.emplace_back(0.1F * a, 0.0F, 1.0F);
  }
  StageTimings timings;
  for (const PointCloud& cloud : {speck, line}) {
    EXPECT_THROW(view_query(clean_query(cloud), kOptions, 1, {}, timings), Error);
  }
}

TEST(CleanQuery, StopsWhenTold) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_THROW(clean_query(testing::frame_in(testing::small_room(2), 1).cloud, context), Error);
}

}  // namespace
}  // namespace landmarkdb
