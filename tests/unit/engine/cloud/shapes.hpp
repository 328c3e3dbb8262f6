#pragma once

#include <cmath>
#include <numbers>

#include "engine/base/random.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::testing {

// Points all over a sphere around zero (spherical Fibonacci set: even, no seed needed).
inline PointCloud make_sphere(std::size_t points, float radius_m) {
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(points);
    const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(i);
    const double ring = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d p(ring * std::cos(angle), ring * std::sin(angle), z);
    cloud.points.push_back(radius_m * p.cast<float>());
  }
  return cloud;
}

// The inner walls of a room [0, size_m] in each axis, points every `spacing_m` give or take a tenth
// of that, which is in the plane of the wall only.
inline PointCloud make_room(const Eigen::Vector3f& size_m, float spacing_m) {
  PointCloud cloud;
  Random random(7);
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const float wall : {0.0F, size_m[axis]}) {
      for (float a = 0.5F * spacing_m; a < size_m[u]; a += spacing_m) {
        for (float b = 0.5F * spacing_m; b < size_m[v]; b += spacing_m) {
          Eigen::Vector3f p;
          p[axis] = wall;
          p[u] = a + spacing_m * static_cast<float>(random.uniform(-0.1, 0.1));
          p[v] = b + spacing_m * static_cast<float>(random.uniform(-0.1, 0.1));
          cloud.points.push_back(p);
        }
      }
    }
  }
  return cloud;
}

}  // namespace landmarkdb::testing
