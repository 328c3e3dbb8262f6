#include "engine/geometry/camera.hpp"

#include <cmath>

#include <Eigen/LU>

namespace landmarkdb {
namespace {

// The polynomial q(s) = 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3, s = r^2: the slope of the distorted
// radius. Where it first reaches zero the lens model folds over.
bool radius_grows_up_to(const std::array<double, 5>& dist, double s) {
  const double a = 3.0 * dist[0], b = 5.0 * dist[1], c = 7.0 * dist[4];
  if (a >= 0.0 && b >= 0.0 && c >= 0.0) return true;
  const auto slope = [&](double at) { return 1.0 + at * (a + at * (b + at * c)); };
  if (!(slope(s) > 0.0)) return false;
  // Its smallest value within [0, s] is at an end or where its own slope a + 2 b s + 3 c s^2 is
  // zero.
  const double discriminant = b * b - 3.0 * a * c;
  if (discriminant < 0.0) return true;
  const double half = -(b + std::copysign(std::sqrt(discriminant), b));
  const double turns[2] = {half / (3.0 * c), a / half};
  for (const double at : turns) {
    if (at > 0.0 && at < s && !(slope(at) > 0.0)) return false;
  }
  return true;
}

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

bool inside_lens_model(const Camera& camera, const Eigen::Vector2d& ray) {
  return radius_grows_up_to(camera.dist, ray.squaredNorm());
}

Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& ray) {
  const Eigen::Vector2d at = lens(camera, ray).at;
  return {camera.fx * at.x() + camera.cx, camera.fy * at.y() + camera.cy};
}

LensPoint distort_with_slope(const Camera& camera, const Eigen::Vector2d& ray) {
  const Lens seen = lens(camera, ray);
  LensPoint point;
  point.uv = {camera.fx * seen.at.x() + camera.cx, camera.fy * seen.at.y() + camera.cy};
  point.duv_dray.row(0) = camera.fx * seen.jacobian.row(0);
  point.duv_dray.row(1) = camera.fy * seen.jacobian.row(1);
  return point;
}

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_camera) {
  if (!(p_camera.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d ray = p_camera.head<2>() / p_camera.z();
  if (!inside_lens_model(camera, ray)) return std::nullopt;
  return distort(camera, ray);
}

bool in_image(const Camera& camera, const Eigen::Vector2d& uv) {
  return uv.x() >= 0.0 && uv.y() >= 0.0 && uv.x() <= camera.width - 1.0 &&
         uv.y() <= camera.height - 1.0;
}

std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& uv) {
  constexpr int kSteps = 20;        // Newton needs 3 to 5 inside the calibrated range
  constexpr double kStill = 1e-15;  // a step this small changes nothing
  constexpr double kConverged_px = 1e-6;
  constexpr double kWidest = 10.0;  // 84 degrees off the axis: no pinhole sees further
  const Eigen::Vector2d target((uv.x() - camera.cx) / camera.fx, (uv.y() - camera.cy) / camera.fy);
  const double focal = std::max(std::abs(camera.fx), std::abs(camera.fy));
  Eigen::Vector2d ray = target;
  for (int step = 0; step < kSteps; ++step) {
    const Lens seen = lens(camera, ray);
    // Where the model folds over, the image is no longer one-to-one and no answer is right.
    if (!(seen.jacobian.determinant() > 0.0) || !(seen.jacobian(0, 0) > 0.0)) return std::nullopt;
    const Eigen::Vector2d change = seen.jacobian.inverse() * (seen.at - target);
    ray -= change;
    if (change.norm() < kStill) break;
  }
  const double error_px = (lens(camera, ray).at - target).norm() * focal;
  if (!(error_px < kConverged_px) || !(ray.norm() < kWidest)) return std::nullopt;
  return inside_lens_model(camera, ray) ? std::optional(ray) : std::nullopt;
}

}  // namespace landmarkdb
