#include "engine/mono/straight_lens.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace landmarkdb {
namespace {

constexpr float kStep_px = 8.0F;

std::optional<Eigen::Vector2d> straight_pixel(const Camera& camera, const Eigen::Vector2d& uv) {
  const std::optional<Eigen::Vector2d> ray = undistort(camera, uv);
  if (!ray) return std::nullopt;
  return Eigen::Vector2d(camera.fx * ray->x() + camera.cx, camera.fy * ray->y() + camera.cy);
}

bool bends(const Camera& camera, double width, double height) {
  constexpr double kLeastShift_px = 0.5;
  if (std::all_of(camera.dist.begin(), camera.dist.end(), [](double d) { return d == 0.0; })) {
    return false;
  }
  for (const double u : {0.0, width / 2.0, width}) {
    for (const double v : {0.0, height / 2.0, height}) {
      const std::optional<Eigen::Vector2d> straight = straight_pixel(camera, {u, v});
      if (!straight || (*straight - Eigen::Vector2d(u, v)).norm() > kLeastShift_px) return true;
    }
  }
  return false;
}

}  // namespace

StraightLens::StraightLens(const std::optional<Camera>& camera,
                           std::uint32_t width,
                           std::uint32_t height) {
  if (!camera || !bends(*camera, width, height)) return;
  camera_ = *camera;
  columns_ = static_cast<std::uint32_t>(static_cast<float>(width) / kStep_px) + 2;
  rows_ = static_cast<std::uint32_t>(static_cast<float>(height) / kStep_px) + 2;
  grid_.reserve(std::size_t{columns_} * rows_);
  for (std::uint32_t row = 0; row < rows_; ++row) {
    for (std::uint32_t column = 0; column < columns_; ++column) {
      const Eigen::Vector2d uv = Eigen::Vector2d(column, row) * double{kStep_px};
      const std::optional<Eigen::Vector2d> straight = straight_pixel(camera_, uv);
      grid_.push_back(straight
                          ? Eigen::Vector2f((*straight - uv).cast<float>())
                          : Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
    }
  }
}

bool StraightLens::look_up(const Eigen::Vector2f& uv, Eigen::Vector2f& straight) const {
  const float x = std::clamp(uv.x() / kStep_px, 0.0F, static_cast<float>(columns_ - 2));
  const float y = std::clamp(uv.y() / kStep_px, 0.0F, static_cast<float>(rows_ - 2));
  const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
  const float a = x - static_cast<float>(column), b = y - static_cast<float>(row);
  const Eigen::Vector2f* at = grid_.data() + row * columns_ + column;
  straight = uv + (1.0F - b) * ((1.0F - a) * at[0] + a * at[1]) +
             b * ((1.0F - a) * at[columns_] + a * at[columns_ + 1]);
  return std::isfinite(straight.x()) && std::isfinite(straight.y());
}

bool StraightLens::straighten(EdgePoint& point) const {
  const Eigen::Vector2f tangent(-point.normal.y(), point.normal.x());
  Eigen::Vector2f here, before, after;
  if (!look_up(point.uv, here) || !look_up(point.uv - tangent, before) ||
      !look_up(point.uv + tangent, after)) {
    return false;
  }
  const Eigen::Vector2f along = (after - before).normalized();
  point.uv = here;
  point.normal = {along.y(), -along.x()};
  return true;
}

Eigen::Vector2d StraightLens::bend(const Eigen::Vector2d& straight) const {
  if (!active()) return straight;
  return distort(
      camera_,
      {(straight.x() - camera_.cx) / camera_.fx, (straight.y() - camera_.cy) / camera_.fy});
}

double StraightLens::bend_direction(const Eigen::Vector2d& straight, double angle_rad) const {
  if (!active()) return angle_rad;
  const Eigen::Vector2d step(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d bent = bend(straight + step) - bend(straight - step);
  return std::atan2(bent.y(), bent.x());
}

}  // namespace landmarkdb
