#pragma once

#include <array>
#include <optional>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// The nearest rotation to R (Frobenius norm), by singular value decomposition.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& R);

// The angle of a rotation, in [0, pi].
double rotation_angle_rad(const Eigen::Matrix3d& R);

// Rotation by the vector `w` (axis times angle, radians).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& w);

// Roll, pitch, yaw in radians, intrinsic z-y-x: R = Rz(yaw) Ry(pitch) Rx(roll). At the poles of the
// pitch roll is set to zero.
Eigen::Vector3d roll_pitch_yaw_rad(const Eigen::Matrix3d& R);

// The smallest rotation that takes direction `from` to direction `to` (any lengths > 0).
Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// Row-major 16 numbers, as they stand in files and on the wire, and back. `from_row_major` throws
// Error{kInvalidArgument} when the numbers are not finite, the last row is not 0 0 0 1, or the 3x3
// part is no rotation within 1e-3; what it returns is an exact rotation (det 1 within 1e-12).
std::array<double, 16> to_row_major(const Eigen::Matrix4d& T);
Eigen::Isometry3d from_row_major(std::span<const double, 16> numbers);

// Least-squares similarity `target = s R source + t` (Umeyama 1991); s = 1 unless `estimate_scale`.
// Needs three finite pairs that are not collinear; nullopt otherwise. `weights`: empty, or one a
// pair.
struct Similarity {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  double scale = 1.0;
  Eigen::Matrix4d matrix() const;
};
std::optional<Similarity> estimate_similarity(std::span<const Eigen::Vector3d> target,
                                              std::span<const Eigen::Vector3d> source,
                                              bool estimate_scale,
                                              std::span<const double> weights = {});

}  // namespace landmarkdb
