#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// How a point was seen.
struct SensorRay {
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();  // unit
  float range_m = 0.0F;

  // How much of a scatter along the ray is left along a normal. Of what is grazed the rest has
  // other causes.
  float steepness(const Eigen::Vector3f& normal) const {
    constexpr float kGrazing = 0.1F;
    return std::max(std::abs(normal.dot(direction)), kGrazing);
  }
};

inline SensorRay ray_to(const PreparedCloud& cloud, std::size_t i) {
  const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
  const Eigen::Vector3f sight = cloud.points[i] - cloud.viewpoints[which];
  const float range_m = sight.norm();
  if (!(range_m > 0.0F)) return {};
  return {sight / range_m, range_m};
}

}  // namespace landmarkdb
