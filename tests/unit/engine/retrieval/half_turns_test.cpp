#include "engine/retrieval/half_turns.hpp"

#include <algorithm>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

// The eight corners of a box, each so often that one end is the heavier.
std::vector<Eigen::Vector3f> corners(const Eigen::Isometry3d& T) {
  std::vector<Eigen::Vector3f> points;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner(k % 2 == 0 ? -3 : 3, k / 2 % 2 == 0 ? -2 : 2, k / 4 == 0 ? -1 : 1);
    const int times = corner.x() > 0.0 ? 3 : 1;
    for (int i = 0; i < times; ++i) points.push_back((T * corner).cast<float>());
  }
  return points;
}

TEST(HalfTurns, LayABoxOntoItselfThoughOneEndHasMorePoints) {
  const Eigen::Isometry3d T = Eigen::Translation3d(5, -4, 2) *
                              Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  const std::vector<Eigen::Vector3f> points = corners(T);
  for (const Eigen::Isometry3d& turn : half_turns(points)) {
    EXPECT_NEAR(rotation_angle_rad(turn.linear()), std::numbers::pi, 1e-6);
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d there = turn * point.cast<double>();
      EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3f& other) {
        return (other.cast<double>() - there).norm() < 1e-4;
      }));
    }
  }
}

}  // namespace
}  // namespace landmarkdb
