#include "engine/retrieval/search.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/retrieval/feature_options.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

FeatureOptions options_at(double voxel_m) {
  return derive_feature_options(
      {8.0, 0.01}, EntryKind::kPlace, KeypointMethod::kStructure, voxel_m);
}

TEST(ViewCache, MakesEachViewOnceAndKeepsItWhereItIs) {
  const CleanQuery query = clean_query(testing::frame_in(testing::small_room(2), 1).cloud);
  const RunContext context;
  StageTimings timings;
  ViewCache views(query, 1, context, timings);
  EXPECT_EQ(views.keypoints(), 0U);
  const QueryView& coarse = views.at(options_at(0.1));
  const std::size_t few = coarse.descriptors.size();
  const QueryView& fine = views.at(options_at(0.05));
  EXPECT_NE(&coarse, &fine);
  EXPECT_EQ(&coarse, &views.at(options_at(0.1)));
  EXPECT_EQ(coarse.descriptors.size(), few);
  EXPECT_NE(fine.descriptors.size(), few);
  EXPECT_EQ(views.keypoints(), std::max(fine.descriptors.size(), few));
}

TEST(ViewCache, IsEmptyWhereTheCloudCannotBeDescribed) {
  PointCloud line;
  for (int i = 0; i < 500; ++i) line.points.emplace_back(0.01F * static_cast<float>(i), 1.0F, 1.0F);
  const CleanQuery query = clean_query(line);
  const RunContext context;
  StageTimings timings;
  ViewCache views(query, 1, context, timings);
  for (const double voxel_m : {0.05, 100.0}) {
    EXPECT_EQ(views.at(options_at(voxel_m)).descriptors.size(), 0U);
    EXPECT_EQ(views.at(options_at(voxel_m)).prepared.size(), 0U);
  }
}

TEST(ViewCache, HasNothingAtAResolutionThatSwallowsTheCloudAndAllAtAnother) {
  const CleanQuery query = clean_query(testing::frame_in(testing::small_room(2), 1).cloud);
  const RunContext context;
  StageTimings timings;
  ViewCache views(query, 1, context, timings);
  EXPECT_EQ(views.at(options_at(100.0)).descriptors.size(), 0U);
  EXPECT_GT(views.at(options_at(0.05)).descriptors.size(), 0U);
}

TEST(GravityOf, NeedsBothSidesToKnowWhichWayIsUp) {
  SceneRecord record;
  QueryOptions options;
  EXPECT_FALSE(gravity_of(options, record));
  options.up = Eigen::Vector3d(0, -3, 0);
  EXPECT_FALSE(gravity_of(options, record));
  record.up = Eigen::Vector3d::UnitZ();
  const std::optional<Gravity> gravity = gravity_of(options, record);
  ASSERT_TRUE(gravity);
  EXPECT_TRUE(gravity->up_source.isApprox(Eigen::Vector3f(0, -1, 0)));
  EXPECT_TRUE(gravity->up_target.isApprox(Eigen::Vector3f(0, 0, 1)));
  options.up = Eigen::Vector3d(0, 0, 1e-200);
  EXPECT_NEAR(gravity_of(options, record)->up_source.norm(), 1.0F, 1e-5F);
  options.up.reset();
  EXPECT_FALSE(gravity_of(options, record));
}

}  // namespace
}  // namespace landmarkdb
