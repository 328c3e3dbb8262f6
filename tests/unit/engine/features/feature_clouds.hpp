#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::testing {

inline void add_point(PreparedCloud& cloud, const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
  cloud.points.push_back(p.cast<float>());
  cloud.normals.push_back(n.normalized().cast<float>());
}

// A square on the plane through `corner` spanned by `u` and `v` (lengths count), one point every
// `spacing_m`, shifted at random by up to 0.3 of it within the plane and, like a sensor's noise, by
// a tenth of it off the plane: on exact planes the signs of the local reference frames are rounding
// alone.
inline void add_plane(PreparedCloud& cloud,
                      const Eigen::Vector3d& corner,
                      const Eigen::Vector3d& u,
                      const Eigen::Vector3d& v,
                      double spacing_m,
                      Random& random) {
  const auto columns = static_cast<int>(u.norm() / spacing_m);
  const auto rows = static_cast<int>(v.norm() / spacing_m);
  const Eigen::Vector3d normal = u.cross(v).normalized();
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const double a = (i + 0.5 + random.uniform(-0.3, 0.3)) / columns;
      const double b = (j + 0.5 + random.uniform(-0.3, 0.3)) / rows;
      const double off = 0.1 * spacing_m * random.normal();
      add_point(cloud, corner + a * u + b * v + off * normal, normal);
    }
  }
}

inline void add_sphere(PreparedCloud& cloud,
                       const Eigen::Vector3d& centre,
                       double radius_m,
                       std::size_t count,
                       Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    const double z = random.uniform(-1.0, 1.0);
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d n(r * std::cos(azimuth), r * std::sin(azimuth), z);
    add_point(cloud, centre + radius_m * n, n);
  }
}

// The corner of a room, two metres a side, with a ball and a box in it, seen from (1, 1, 1).
inline PreparedCloud corner_room(std::uint64_t seed) {
  Random random(seed);
  PreparedCloud cloud;
  const Eigen::Vector3d o = Eigen::Vector3d::Zero();
  const Eigen::Vector3d x(2, 0, 0);
  const Eigen::Vector3d y(0, 2, 0);
  const Eigen::Vector3d z(0, 0, 2);
  constexpr double kSpacing = 0.04;
  add_plane(cloud, o, x, y, kSpacing, random);
  add_plane(cloud, o, y, z, kSpacing, random);
  add_plane(cloud, o, z, x, kSpacing, random);
  add_sphere(cloud, {0.6, 0.7, 0.3}, 0.3, 700, random);
  const Eigen::Vector3d b(1.2, 0.3, 0.0);
  add_plane(cloud, b, {0, 0, 0.5}, {0, 0.6, 0}, kSpacing, random);
  add_plane(cloud, b + Eigen::Vector3d(0, 0, 0.5), {0.4, 0, 0}, {0, 0.6, 0}, kSpacing, random);
  cloud.resolution_m = kSpacing;
  cloud.viewpoints = {Eigen::Vector3f(1, 1, 1)};
  cloud.normals_from_viewpoint = true;
  return cloud;
}

inline Keypoints every(const PreparedCloud& cloud, std::size_t step) {
  Keypoints keypoints;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    keypoints.index.push_back(static_cast<std::uint32_t>(i));
  }
  return keypoints;
}

}  // namespace landmarkdb::testing
