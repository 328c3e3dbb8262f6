#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// Moves image points to where the same camera without lens distortion would see them ("straight
// pixels"), so that straight edges are straight, and back.
class StraightLens {
 public:
  // Nothing moves without a camera, or where its distortion stays below half a pixel everywhere.
  StraightLens(const std::optional<Camera>& camera, std::uint32_t width, std::uint32_t height);

  bool active() const { return !grid_.empty(); }

  // By a table every 8 px, within 0.02 px of the exact; false where the lens model does not reach.
  bool straighten(EdgePoint& point) const;

  // Exact.
  Eigen::Vector2d bend(const Eigen::Vector2d& straight) const;
  // The direction (radians) that one at a straight place has in the image.
  double bend_direction(const Eigen::Vector2d& straight, double angle_rad) const;

 private:
  bool look_up(const Eigen::Vector2f& uv, Eigen::Vector2f& straight) const;

  Camera camera_;
  std::uint32_t columns_ = 0, rows_ = 0;
  std::vector<Eigen::Vector2f> grid_;  // shifts, NaN where the model does not reach
};

}  // namespace landmarkdb
