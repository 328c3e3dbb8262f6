#include "engine/cloud/reach.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(MeasureReach, IsThreeThousandTimesTheBulkAndNotMovedByFarPoints) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(static_cast<float>(i), 7.0F, 0.0F);
  const Reach reach = measure_reach(points);
  EXPECT_NEAR(reach.centre.x(), 50.0, 1.0);
  EXPECT_NEAR(reach.far_m, 3000.0 * 50.0, 5000.0);
  for (int i = 0; i < 20; ++i) points.emplace_back(1e20F, 1e20F, -1e20F);
  EXPECT_NEAR(measure_reach(points).far_m, reach.far_m, 0.5 * reach.far_m);
}

TEST(MeasureReach, IsAHundredMetresForASpot) {
  const std::vector<Eigen::Vector3f> points(50, Eigen::Vector3f(1, 2, 3));
  const Reach reach = measure_reach(points);
  EXPECT_TRUE(reach.holds({100.5F, 2, 3}));
  EXPECT_FALSE(reach.holds({1, 2, -98}));
  EXPECT_FALSE(reach.holds({std::numeric_limits<float>::quiet_NaN(), 2, 3}));
}

std::vector<std::uint32_t> all_of(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

// 20 x 20 x 10 m, a point a metre.
std::vector<Eigen::Vector3f> bulk() {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i) {
    points.emplace_back(
        static_cast<float>(i % 20), static_cast<float>(i / 20 % 20), static_cast<float>(i / 400));
  }
  return points;
}

TEST(DropFarAlone, KeepsWhatIsAtHandHoweverThin) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i) points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  std::vector<std::uint32_t> kept = all_of(points);
  EXPECT_EQ(drop_far_alone(points, measure_reach(points), kept, {}), 0U);
  EXPECT_EQ(kept, all_of(points));
}

TEST(DropFarAlone, AsksForCompanyByTheWayThere) {
  const std::vector<Eigen::Vector3f> points = bulk();
  const auto with_row = [&](float away, float apart) {
    std::vector<Eigen::Vector3f> more = points;
    for (int i = 0; i < 8; ++i) more.emplace_back(away, apart * static_cast<float>(i), 0.0F);
    std::vector<std::uint32_t> kept = all_of(more);
    const std::size_t dropped = drop_far_alone(more, measure_reach(more), kept, {});
    EXPECT_EQ(kept.size(), more.size() - dropped);
    EXPECT_TRUE(std::ranges::is_sorted(kept));
    return dropped;
  };
  EXPECT_EQ(with_row(100.0F, 1.0F), 0U);
  EXPECT_EQ(with_row(100.0F, 30.0F), 8U);
  EXPECT_EQ(with_row(1000.0F, 10.0F), 0U);
  EXPECT_EQ(with_row(1000.0F, 300.0F), 8U);
}

TEST(DropFarAlone, KeepsASurfaceAcrossTheEndsOfItsShells) {
  const std::vector<Eigen::Vector3f> points = bulk();
  const Reach reach = measure_reach(points);
  for (const double shells : {1.0, 2.0, 4.0}) {
    std::vector<Eigen::Vector3f> more = points;
    const double end_m = shells * reach.near_m;
    for (int i = -50; i < 3; ++i) {  // three just beyond
      more.push_back((reach.centre + Eigen::Vector3d(0, end_m + 0.02 * i + 0.01, 0)).cast<float>());
    }
    std::vector<std::uint32_t> kept = all_of(more);
    EXPECT_EQ(drop_far_alone(more, reach, kept, {}), 0U) << shells;
  }
}

TEST(DropFarAlone, KeepsASparseCloudWholeAndOneNextToNothing) {
  std::vector<Eigen::Vector3f> sparse;
  for (int i = 0; i < 1000; ++i) {
    sparse.emplace_back(static_cast<float>(i % 10), static_cast<float>(i / 10 % 10), 0.0F);
  }
  for (int i = 0; i < 20; ++i)
    sparse.emplace_back(100.0F + 30.0F * static_cast<float>(i), 0.0F, 0.0F);
  std::vector<std::uint32_t> kept = all_of(sparse);
  EXPECT_EQ(drop_far_alone(sparse, measure_reach(sparse), kept, {}), 0U);
  std::vector<Eigen::Vector3f> spot;
  for (int i = 0; i < 900; ++i) spot.emplace_back(1e-20F * static_cast<float>(i), 1.0F, 2.0F);
  spot.emplace_back(50.0F, 1.0F, 2.0F);
  kept = all_of(spot);
  EXPECT_EQ(drop_far_alone(spot, measure_reach(spot), kept, {}), 0U);
}

TEST(DropFarAlone, NothingIsFarFromASpotOrAHandful) {
  for (const int count : {50, 200}) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < count; ++i) {
      points.emplace_back(count < 100 ? static_cast<float>(i) : 1.0F, 2.0F, 3.0F);
    }
    points.emplace_back(1.0F, 900.0F, 3.0F);
    std::vector<std::uint32_t> kept = all_of(points);
    EXPECT_EQ(drop_far_alone(points, measure_reach(points), kept, {}), 0U) << count;
  }
}

}  // namespace
}  // namespace landmarkdb
