#include "engine/cloud/resolution.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "tests/unit/engine/cloud/shapes.hpp"

namespace landmarkdb {
namespace {

TEST(MeasureScale, FindsTheSpacingOfAnEvenCloudOfAnySize) {
  for (const float scale : {0.05F, 1.0F, 40.0F}) {
    const float spacing = 0.03F * scale;
    const PointCloud cloud = testing::make_room(scale * Eigen::Vector3f(3, 2, 1.5F), spacing);
    const CloudScale measured = measure_scale(cloud);
    EXPECT_NEAR(measured.spacing_m, spacing, 0.15 * spacing);
    EXPECT_NEAR(measured.extent_m, scale * 3.905, 0.05 * scale);
  }
}

TEST(MeasureScale, CountsEachPieceOfSurfaceOnce) {
  // A patch on the wall a hundred times denser than the rest, with most of the points.
  PointCloud cloud = testing::make_room({6, 4, 3}, 0.05F);
  const std::size_t even = cloud.size();
  for (int i = 0; i < 200 * 200; ++i) {
    cloud.points.emplace_back(
        0.005F * static_cast<float>(i % 200), 0.005F * static_cast<float>(i / 200), 0.0F);
  }
  EXPECT_GT(cloud.size() - even, even / 2);
  EXPECT_NEAR(measure_scale(cloud).spacing_m, 0.05, 0.01);
}

TEST(MeasureScale, AgreesOnBothSidesOfTheSizeWhereItChangesMethod) {
  const PointCloud below = testing::make_room({6, 5, 3}, 0.026F);
  const PointCloud above = testing::make_room({6, 5, 3}, 0.024F);
  ASSERT_LT(below.size(), 200'000U);
  ASSERT_GT(above.size(), 200'000U);
  EXPECT_NEAR(measure_scale(below).spacing_m, 0.026, 0.003);
  EXPECT_NEAR(measure_scale(above).spacing_m, 0.024, 0.003);
}

TEST(MeasureScale, IsNotMovedByAFewStrayPoints) {
  PointCloud cloud = testing::make_room({6, 5, 3}, 0.05F);
  const CloudScale before = measure_scale(cloud);
  for (int i = 0; i < 10; ++i) {
    cloud.points.emplace_back(500.0F + static_cast<float>(i), 0.0F, -300.0F);
  }
  const CloudScale after = measure_scale(cloud);
  EXPECT_NEAR(after.extent_m, before.extent_m, 0.05);
  EXPECT_NEAR(after.spacing_m, before.spacing_m, 0.005);
}

TEST(MeasureScale, CountsPointsByTheirWeights) {
  // Nine tenths of the points on one short wall: its ends are the extent, condensed or not.
  PointCloud cloud = testing::make_room({6, 5, 3}, 0.1F);
  Random random(1);
  for (int i = 0; i < 2'000'000; ++i) {
    cloud.points.emplace_back(
        0.0F, static_cast<float>(random.uniform(0, 1)), static_cast<float>(random.uniform(0, 1)));
  }
  const CloudScale whole = measure_scale(cloud);
  EXPECT_LT(whole.extent_m, 2.0);
  condense(cloud, 0.01);
  const CloudScale condensed = measure_scale(cloud);
  EXPECT_NEAR(condensed.extent_m, whole.extent_m, 0.03);
  EXPECT_NEAR(measure_extent(cloud), condensed.extent_m, 1e-12);
  cloud.weights.clear();
  EXPECT_GT(measure_scale(cloud).extent_m, 4.0);
}

TEST(MeasureScale, FindsTheSpacingOfACondensedCloudWhereItIsLargerThanItsCells) {
  PointCloud sparse = testing::make_room({6, 5, 3}, 0.04F);
  const CloudScale whole = measure_scale(sparse);
  condense(sparse, 0.01);
  EXPECT_NEAR(measure_scale(sparse).spacing_m, whole.spacing_m, 0.002);

  // Twenty points at each place: the sixteenth neighbour of each is at its own.
  PointCloud dense = testing::make_room({6, 5, 3}, 0.04F);
  const PointCloud once = dense;
  for (int copy = 0; copy < 19; ++copy) {
    dense.points.insert(dense.points.end(), once.points.begin(), once.points.end());
  }
  condense(dense, 0.01);
  EXPECT_LT(dense.size(), once.size() + 1);
  EXPECT_LT(measure_scale(dense).spacing_m, 0.01);
}

TEST(MeasureScale, NeedsFourPoints) {
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(measure_scale(cloud), Error);
  cloud.points.emplace_back(0.0F, 0.0F, 1.0F);
  const CloudScale scale = measure_scale(cloud);
  EXPECT_GT(scale.spacing_m, 0.5);
  EXPECT_LT(scale.spacing_m, 2.0);
}

TEST(UnitsLookWrong, FlagsARoomInMillimetresAndAnObjectInKilometres) {
  EXPECT_FALSE(units_look_wrong({.extent_m = 8.0}, EntryKind::kPlace));
  EXPECT_FALSE(units_look_wrong({.extent_m = 120.0}, EntryKind::kPlace));
  EXPECT_TRUE(units_look_wrong({.extent_m = 8000.0}, EntryKind::kPlace));
  EXPECT_TRUE(units_look_wrong({.extent_m = 0.008}, EntryKind::kPlace));
  EXPECT_FALSE(units_look_wrong({.extent_m = 0.3}, EntryKind::kObject));
  EXPECT_TRUE(units_look_wrong({.extent_m = 300.0}, EntryKind::kObject));
  EXPECT_TRUE(units_look_wrong({.extent_m = 0.0003}, EntryKind::kObject));
}

}  // namespace
}  // namespace landmarkdb
