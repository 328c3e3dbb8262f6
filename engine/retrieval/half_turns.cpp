#include "engine/retrieval/half_turns.hpp"

#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace landmarkdb {

std::array<Eigen::Isometry3d, 3> half_turns(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& point : points) mean += point.cast<double>();
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d d = point.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3d along = axes.transpose() * point.cast<double>();
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  const Eigen::Vector3d middle = axes * (0.5 * (low + high));
  std::array<Eigen::Isometry3d, 3> turns;
  for (int k = 0; k < 3; ++k) {
    turns[static_cast<std::size_t>(k)] = Eigen::Translation3d(middle) *
                                         Eigen::AngleAxisd(std::numbers::pi, axes.col(k)) *
                                         Eigen::Translation3d(-middle);
  }
  return turns;
}

}  // namespace landmarkdb
