#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace landmarkdb {

// The smallest rotation that takes unit direction d to (0, 0, 1). d must not be (0, 0, -1), which
// no camera sees.
inline Eigen::Matrix3d turn_to_axis(const Eigen::Vector3d& d) {
  // Rodrigues' formula with the axis d x z: 1 / (1 + cos) is (1 - cos) / sin^2.
  const double x = d.x(), y = d.y(), z = d.z(), k = 1.0 / (1.0 + z);
  Eigen::Matrix3d Q;
  Q << 1.0 - k * x * x, -k * x * y, -x, -k * x * y, 1.0 - k * y * y, -y, x, y, z;
  return Q;
}

// The same for the mean of unit rays through (x, y, 1).
template <std::size_t N>
Eigen::Matrix3d turn_into_sight(const std::array<Eigen::Vector2d, N>& rays) {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& ray : rays) d += ray.homogeneous().normalized();
  return turn_to_axis(d.normalized());
}

// A ray through the turned camera.
inline Eigen::Vector2d turned(const Eigen::Matrix3d& Q, const Eigen::Vector2d& ray) {
  const Eigen::Vector3d at = Q * ray.homogeneous();
  return at.head<2>() / at.z();
}

template <std::size_t N>
std::array<Eigen::Vector2d, N> turned(const Eigen::Matrix3d& Q,
                                      const std::array<Eigen::Vector2d, N>& rays) {
  std::array<Eigen::Vector2d, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = turned(Q, rays[i]);
  return result;
}

}  // namespace landmarkdb
