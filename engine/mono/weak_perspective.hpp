#pragma once

#include <cmath>

#include <Eigen/Core>

namespace landmarkdb {

// How a plane stands under weak perspective: what its affine map to the image says.
struct PlaneTilt {
  double depth = 0.0;      // s: of the plane's origin; the only one
  double cos_tilt = 0.0;   // of the plane against the image
  bool square_on = false;  // no tilt: w is zero and both solutions are one
  bool mirrored = false;   // det A < 0: the plane's normal points towards the camera
  Eigen::Vector2d w;       // what the normal adds to the first two rows of R; or its negative
};

// Solves A = 1/s (first two rows of R) on the plane's axes, A the 2x2 map from plane coordinates to
// rays. False where A is zero or not finite. No subtraction of nearly equal numbers: exact to the
// last digits for any tilt.
inline bool solve_plane_tilt(const Eigen::Matrix2d& A, PlaneTilt& tilt) {
  const double p = A(0, 0) * A(0, 0) + A(0, 1) * A(0, 1);
  const double q = A(1, 0) * A(1, 0) + A(1, 1) * A(1, 1);
  const double r = A(0, 0) * A(1, 0) + A(0, 1) * A(1, 1);
  const double h = std::sqrt((p - q) * (p - q) + 4.0 * r * r);
  const double lam1 = 0.5 * (p + q + h);  // the larger eigenvalue of A A^T
  if (!std::isfinite(lam1) || !(lam1 > 0.0)) return false;
  const double det = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  tilt.depth = 1.0 / std::sqrt(lam1);
  tilt.cos_tilt = std::abs(det) / lam1;
  tilt.mirrored = det < 0.0;
  tilt.square_on = !(h > 0.0);
  tilt.w.setZero();
  if (tilt.square_on) return true;
  // g (-sin theta, cos theta) with cos 2 theta = (p - q) / h and sin 2 theta = 2 r / h.
  const double g = std::sqrt(h / lam1);
  const double larger = std::sqrt(0.5 * (1.0 + std::abs(p - q) / h));
  const double smaller = std::abs(r) / (h * larger);
  tilt.w = p >= q ? Eigen::Vector2d(-g * std::copysign(smaller, r), g * larger)
                  : Eigen::Vector2d(-g * std::copysign(larger, r), g * smaller);
  return true;
}

}  // namespace landmarkdb
