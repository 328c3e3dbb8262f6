#include "engine/cloud/reach.hpp"

#include <limits>
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

}  // namespace
}  // namespace landmarkdb
