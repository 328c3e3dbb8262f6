#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb {

// Four points of an image as rays (x, y at z = 1) of the camera turned towards them.
struct TurnedFour {
  Eigen::Matrix3d Q;  // what turns it
  std::array<Eigen::Vector2d, 4> rays;
};

// A four of a model as an image's four shows it: scaled orthography about the first point, in the
// camera that is turned to it, with perspective correction (DeMenthon & Davis 1995). `seen` must
// outlive it.
class FourPose {
 public:
  FourPose(std::span<const PosePoint> points,
           const std::array<std::uint16_t, 4>& model,
           const TurnedFour& seen)
      : seen_(seen), origin_(points[model[0]].xyz) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      E_.row(k) = points[model[static_cast<std::size_t>(k) + 1]].xyz - origin_;
    }
    inverse_ = E_.inverse();
    fit(Eigen::Vector3d::Ones());
  }

  // Where the camera is, in the object frame; of any length.
  Eigen::Vector3d to_camera() const { return -L_.col(0).cross(L_.col(1)); }

  // One round of perspective correction, with the depths that the map has now.
  void correct() {
    const double size = std::sqrt(0.5 * L_.squaredNorm());  // 1 / s
    fit(Eigen::Vector3d::Ones() + size * (E_ * -to_camera().normalized()));
  }

  // How far the map's two rows are from orthogonal and equally long, in sigmas of what noise of
  // `sigma` (of a ray's coordinate) makes of that.
  double sigmas(double sigma) const {
    const double across = L_.col(0).squaredNorm() - L_.col(1).squaredNorm();
    const double off = std::hypot(across, 2.0 * L_.col(0).dot(L_.col(1)));
    return off / (2.0 * std::numbers::sqrt2 * sigma * (inverse_.transpose() * L_).norm());
  }

  // The nearest rotation to the map's rows; false where there is none.
  bool pose(RigidPose& result) const {
    const Eigen::Matrix2d M = L_.transpose() * L_;
    const double root = std::sqrt(std::max(0.0, M.determinant()));
    const double trace = std::sqrt(M.trace() + 2.0 * root);  // of M^(1/2)
    if (!(root > 0.0) || !std::isfinite(trace)) return false;
    Eigen::Matrix2d G = M;
    G.diagonal().array() += root;
    const Eigen::Matrix<double, 2, 3> rows = trace * G.inverse() * L_.transpose();
    Eigen::Matrix3d R;
    R << rows, rows.row(0).cross(rows.row(1));
    const Eigen::Vector3d t = 2.0 / trace * seen_.rays[0].homogeneous() - R * origin_;
    result = {seen_.Q.transpose() * R, seen_.Q.transpose() * t};
    return result.t.allFinite();
  }

 private:
  // `nearer`: 1 + e_i, by how much points 1 to 3 are further away than point 0.
  void fit(const Eigen::Vector3d& nearer) {
    Eigen::Matrix<double, 3, 2> w;
    for (Eigen::Index k = 0; k < 3; ++k) {
      w.row(k) = seen_.rays[static_cast<std::size_t>(k) + 1] * nearer(k) - seen_.rays[0];
    }
    L_ = inverse_ * w;
  }

  const TurnedFour& seen_;
  Eigen::Vector3d origin_;
  Eigen::Matrix3d E_, inverse_;
  Eigen::Matrix<double, 3, 2> L_;  // the first two rows of the rotation over the depth
};

}  // namespace landmarkdb
