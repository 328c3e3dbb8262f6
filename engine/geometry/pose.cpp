#include "engine/geometry/pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include <Eigen/Dense>

#include "engine/base/error.hpp"

namespace landmarkdb {

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& R) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) *= -1.0;
  return U * svd.matrixV().transpose();
}

double rotation_angle_rad(const Eigen::Matrix3d& R) {
  // atan2 keeps its precision at both ends, where acos of the trace loses half the digits.
  const Eigen::Vector3d w(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(w.norm(), R.trace() - 1.0);
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d roll_pitch_yaw_rad(const Eigen::Matrix3d& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  constexpr double kPole = 1e-9;  // cos(pitch) below which roll and yaw turn about the same axis
  if (std::hypot(R(0, 0), R(1, 0)) < kPole) {
    return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  }
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

std::array<double, 16> to_row_major(const Eigen::Matrix4d& T) {
  std::array<double, 16> numbers{};
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col)
      numbers[static_cast<std::size_t>(4 * row + col)] = T(row, col);
  }
  return numbers;
}

Eigen::Isometry3d from_row_major(std::span<const double, 16> numbers) {
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  if (!T.allFinite())
    throw Error(ErrorCode::kInvalidArgument, "a pose has a number that is not finite");
  constexpr double kTolerance = 1e-3;  // poses are often written with four digits
  if ((T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kTolerance) {
    std::ostringstream message;
    message << "the last row of a pose is " << T.row(3)
            << ", want 0 0 0 1 (16 numbers, row by row)";
    throw Error(ErrorCode::kInvalidArgument, message.str());
  }
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const Eigen::Matrix3d R_near = nearest_rotation(R);
  if ((R - R_near).cwiseAbs().maxCoeff() > kTolerance) {
    std::ostringstream message;
    message << "the 3x3 part of a pose is no rotation: off by "
            << (R - R_near).cwiseAbs().maxCoeff() << ", want at most " << kTolerance;
    throw Error(ErrorCode::kInvalidArgument, message.str());
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = R_near;
  pose.translation() = T.topRightCorner<3, 1>();
  return pose;
}

Eigen::Matrix4d Similarity::matrix() const {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = scale * R;
  T.topRightCorner<3, 1>() = t;
  return T;
}

std::optional<Similarity> estimate_similarity(std::span<const Eigen::Vector3d> target,
                                              std::span<const Eigen::Vector3d> source,
                                              bool estimate_scale,
                                              std::span<const double> weights) {
  const std::size_t n = std::min(target.size(), source.size());
  if (n < 3) return std::nullopt;
  auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double total = 0.0;
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) {
    total += weight(i);
    target_mean += weight(i) * target[i];
    source_mean += weight(i) * source[i];
  }
  if (!(total > 0.0)) return std::nullopt;
  target_mean /= total;
  source_mean /= total;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Umeyama (38)
  double source_variance = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d a = target[i] - target_mean;
    const Eigen::Vector3d b = source[i] - source_mean;
    covariance += weight(i) / total * a * b.transpose();
    source_variance += weight(i) / total * b.squaredNorm();
  }
  // Eigen leaves the factors of such a matrix as they were in memory.
  if (!covariance.allFinite() || !std::isfinite(source_variance)) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d = svd.singularValues();
  constexpr double kRank =
      1e-9;  // second singular value against the first: below, the points are collinear
  if (!(d(0) > 0.0) || d(1) <= kRank * d(0) || !(source_variance > 0.0)) return std::nullopt;
  Eigen::Vector3d s(1.0, 1.0, 1.0);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) s(2) = -1.0;  // (43)
  Similarity result;
  result.R = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  result.scale = estimate_scale ? d.dot(s) / source_variance : 1.0;
  if (!(result.scale > 0.0) || !result.R.allFinite()) return std::nullopt;
  result.t = target_mean - result.scale * result.R * source_mean;
  return result;
}

}  // namespace landmarkdb
