#include "engine/registration/gyration.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

// A square of 2 m, points on its rim.
std::vector<Eigen::Vector3f> square() {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 400; ++i) {
    const float along = 2.0F * static_cast<float>(i % 100) / 100.0F - 1.0F;
    const int side = i / 100;
    const float rim = side % 2 == 0 ? 1.0F : -1.0F;
    points.emplace_back(side < 2 ? along : rim, side < 2 ? rim : along, 5.0F);
  }
  return points;
}

TEST(MeasureGyration, IsMeanAndRootMeanSquare) {
  const Gyration gyration = measure_gyration(square());
  EXPECT_NEAR((gyration.centre - Eigen::Vector3d(0, 0, 5)).norm(), 0.0, 0.02);
  EXPECT_NEAR(gyration.radius_m, std::sqrt(4.0 / 3.0), 0.01);
  EXPECT_EQ(measure_gyration({}).radius_m, 0.0);
  const std::vector<Eigen::Vector3f> spot(3, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(measure_gyration(spot).radius_m, 0.0);
}

TEST(MeasureGyration, IsNotThatOfAFewFarPoints) {
  for (const auto& [away, count] :
       {std::pair{60.0F, 1}, {1000.0F, 1}, {1e6F, 1}, {60.0F, 40}, {1000.0F, 40}}) {
    std::vector<Eigen::Vector3f> points = square();
    for (int i = 0; i < count; ++i) points.emplace_back(0.0F, away, 0.01F * static_cast<float>(i));
    const Gyration gyration = measure_gyration(points);
    EXPECT_LT((gyration.centre - Eigen::Vector3d(0, 0, 5)).norm(), 0.05) << away;
    EXPECT_NEAR(gyration.radius_m, std::sqrt(4.0 / 3.0), 0.05) << away;
  }
}

TEST(MeasureGyration, CountsALongTailWhole) {
  std::vector<Eigen::Vector3f> points = square();
  for (int i = 0; i < 40; ++i) points.emplace_back(0.0F, 2.0F + 0.4F * static_cast<float>(i), 5.0F);
  double sum = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points)
    mean += p.cast<double>() / static_cast<double>(points.size());
  for (const Eigen::Vector3f& p : points) sum += (p.cast<double>() - mean).squaredNorm();
  EXPECT_NEAR(
      measure_gyration(points).radius_m, std::sqrt(sum / static_cast<double>(points.size())), 1e-9);
}

}  // namespace
}  // namespace landmarkdb
