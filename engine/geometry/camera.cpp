#include "engine/geometry/camera.hpp"

#include <cmath>

#include <Eigen/LU>

namespace landmarkdb {
namespace {

struct Lens {
  Eigen::Vector2d at;        // the distorted direction
  Eigen::Matrix2d jacobian;  // of it, by the direction
};

// Brown's model as OpenCV and ROS (plumb_bob) write it.
Lens lens(const Camera& camera, const Eigen::Vector2d& ray) {
  const auto& [k1, k2, p1, p2, k3] = camera.dist;
  const double x = ray.x(), y = ray.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3);  // d radial / d r2
  Lens result;
  result.at = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
               y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double mixed = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
  result.jacobian << radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed, mixed,
      radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return result;
}

}  // namespace

Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& ray) {
  const Eigen::Vector2d at = lens(camera, ray).at;
  return {camera.fx * at.x() + camera.cx, camera.fy * at.y() + camera.cy};
}

std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& uv) {
  constexpr int kSteps = 20;  // Newton needs 3 to 5 inside the calibrated range
  constexpr double kConverged_px = 1e-6;
  constexpr double kWidest = 10.0;  // 84 degrees off the axis: no pinhole sees further
  const Eigen::Vector2d target((uv.x() - camera.cx) / camera.fx, (uv.y() - camera.cy) / camera.fy);
  const double focal = std::max(camera.fx, camera.fy);
  Eigen::Vector2d ray = target;
  for (int step = 0; step < kSteps; ++step) {
    const Lens seen = lens(camera, ray);
    // Where the model folds over, the image is no longer one-to-one and no answer is right.
    if (!(seen.jacobian.determinant() > 0.0) || !(seen.jacobian(0, 0) > 0.0)) return std::nullopt;
    const Eigen::Vector2d error = seen.at - target;
    if (error.norm() * focal < kConverged_px) {
      return ray.norm() < kWidest ? std::optional(ray) : std::nullopt;
    }
    ray -= seen.jacobian.inverse() * error;
  }
  return std::nullopt;
}

}  // namespace landmarkdb
