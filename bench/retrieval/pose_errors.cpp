#include "bench/retrieval/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace landmarkdb::bench {

PoseError pose_error(const Eigen::Isometry3d& truth, const Eigen::Isometry3d& estimate) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  constexpr double kMillimetres = 1000.0;
  const Eigen::Isometry3d off = truth.inverse() * estimate;
  const Eigen::AngleAxisd turn(off.linear());
  PoseError error;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    error.xyz_mm[at] = kMillimetres * off.translation()[i];
    error.pitch_yaw_roll_deg[at] = kDegrees * turn.angle() * turn.axis()[i];
  }
  error.metres = off.translation().norm();
  error.degrees = kDegrees * std::abs(turn.angle());
  return error;
}

std::array<double, 6> ErrorTally::mean_absolute() const {
  std::array<double, 6> mean{};
  const std::size_t count = right.size() + wrong_ones.size();
  if (count == 0) return mean;
  for (const auto* errors : {&right, &wrong_ones}) {
    for (const PoseError& error : *errors) {
      for (std::size_t i = 0; i < 3; ++i) {
        mean[i] += std::abs(error.xyz_mm[i]) / static_cast<double>(count);
        mean[i + 3] += std::abs(error.pitch_yaw_roll_deg[i]) / static_cast<double>(count);
      }
    }
  }
  return mean;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace landmarkdb::bench
