#include "engine/cloud/gathered_points.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// A wall at x = 1 whose points scatter by this much, and one two metres behind it.
std::vector<Eigen::Vector3f> two_walls(double sigma_m) {
  Random random(4);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 4000; ++i) {
    const double x = (i % 2 == 0 ? 1.0 : 3.0) + sigma_m * random.normal();
    points.push_back(
        Eigen::Vector3d(x, random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)).cast<float>());
  }
  return points;
}

TEST(GatheredPoints, FitsThePlaneOfThePointsWithinTheRadius) {
  const CellGrid grid(two_walls(0.02), 0.125);
  GatheredPoints around;
  around.gather(grid, {1.0F, 0.0F, 0.0F}, 0.6F);
  const ScatterPlane plane = around.fit_plane({1.0F, 0.1F, -0.1F}, 0.4F);
  EXPECT_GT(std::abs(plane.normal.x()), 0.99F);
  EXPECT_NEAR(plane.mean.x(), 1.0F, 0.01F);
  EXPECT_NEAR(plane.sigma_m, 0.02F, 0.005F);
}

TEST(GatheredPoints, HoldsEveryPointNearerThanItWasAskedFor) {
  const std::vector<Eigen::Vector3f> points = two_walls(0.02);
  const CellGrid grid(points, 0.125);
  const Eigen::Vector3f centre(1.0F, 0.3F, 0.2F);
  constexpr float kRadius = 0.5F;
  const auto near = [&](const Eigen::Vector3f& p) { return (p - centre).norm() < kRadius; };
  GatheredPoints around;
  around.gather(grid, {3.0F, 0.0F, 0.0F}, 0.3F);  // what was there before is gone
  around.gather(grid, centre, kRadius);
  std::size_t expected = 0;
  for (const Eigen::Vector3f& p : points) expected += near(p) ? 1U : 0U;
  std::size_t found = 0;
  for (std::size_t i = 0; i < around.size(); ++i) found += near(around.point(i)) ? 1U : 0U;
  EXPECT_EQ(found, expected);
  EXPECT_LT(around.size(), points.size() / 2);
}

TEST(GatheredPoints, FindsNoPlaneAboutAHandfulOfPoints) {
  const CellGrid grid(two_walls(0.02), 0.125);
  GatheredPoints around;
  around.gather(grid, {2.0F, 0.0F, 0.0F}, 0.3F);
  EXPECT_TRUE(std::isinf(around.fit_plane({2.0F, 0.0F, 0.0F}, 0.3F).sigma_m));
}

}  // namespace
}  // namespace landmarkdb
