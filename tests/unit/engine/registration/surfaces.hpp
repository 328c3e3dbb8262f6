#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::testing {

// Exact surfaces with their normals, made of rectangles.
struct Surface {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;

  // A rectangle at `corner` spanned by `u` and `v`, one point every `spacing_m` at a random place
  // of its square; the normal is u x v.
  void add(const Eigen::Vector3d& corner,
           const Eigen::Vector3d& u,
           const Eigen::Vector3d& v,
           double spacing_m,
           Random& random) {
    const Eigen::Vector3f normal = u.cross(v).normalized().cast<float>();
    const int columns = static_cast<int>(u.norm() / spacing_m);
    const int rows = static_cast<int>(v.norm() / spacing_m);
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const Eigen::Vector3d p =
            corner + (i + random.uniform()) / columns * u + (j + random.uniform()) / rows * v;
        points.push_back(p.cast<float>());
        normals.push_back(normal);
      }
    }
  }

  // The same surface as a sensor at T_here_sensor has it: T^-1 * p.
  Surface seen_from(const Eigen::Isometry3d& T_here_sensor) const {
    const Eigen::Isometry3d T = T_here_sensor.inverse();
    Surface seen;
    for (const Eigen::Vector3f& p : points) {
      seen.points.emplace_back((T * p.cast<double>()).cast<float>());
    }
    for (const Eigen::Vector3f& n : normals) {
      seen.normals.emplace_back((T.linear() * n.cast<double>()).cast<float>());
    }
    return seen;
  }
};

// Three walls 3 m a side that meet in zero, and a box: all six freedoms are fixed.
inline Surface corner_room(double spacing_m, std::uint64_t seed = 1) {
  Random random(seed);
  const Eigen::Vector3d o = Eigen::Vector3d::Zero();
  const Eigen::Vector3d x(3, 0, 0), y(0, 3, 0), z(0, 0, 3);
  Surface surface;
  surface.add(o, x, y, spacing_m, random);
  surface.add(o, y, z, spacing_m, random);
  surface.add(o, z, x, spacing_m, random);
  const Eigen::Vector3d b(1.5, 0.8, 0.0);
  surface.add(b, {0, 0, 0.7}, {0, 0.9, 0}, spacing_m, random);
  surface.add(b, {0.6, 0, 0}, {0, 0, 0.7}, spacing_m, random);
  surface.add(b + Eigen::Vector3d(0, 0, 0.7), {0.6, 0, 0}, {0, 0.9, 0}, spacing_m, random);
  return surface;
}

// A wall z = 0, 4 m a side: three freedoms are left.
inline Surface lone_wall(double spacing_m, std::uint64_t seed = 1) {
  Random random(seed);
  Surface surface;
  surface.add({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, spacing_m, random);
  return surface;
}

// A corridor along x, 2 m wide and high: a slide along it is left.
inline Surface corridor(double spacing_m, std::uint64_t seed = 1) {
  Random random(seed);
  Surface surface;
  const Eigen::Vector3d along(10, 0, 0);
  surface.add({-5, -1, 0}, along, {0, 2, 0}, spacing_m, random);
  surface.add({-5, -1, 2}, {0, 2, 0}, along, spacing_m, random);
  surface.add({-5, -1, 0}, {0, 0, 2}, along, spacing_m, random);
  surface.add({-5, 1, 0}, along, {0, 0, 2}, spacing_m, random);
  return surface;
}

// Turned by up to `angle_rad`, moved by up to `metres` an axis.
inline Eigen::Isometry3d random_pose(Random& random, double angle_rad, double metres) {
  const auto vector = [&](double size) {
    return Eigen::Vector3d(
        random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
  };
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector(random.uniform(0.0, angle_rad) * vector(1.0).normalized());
  T.translation() = vector(metres);
  return T;
}

}  // namespace landmarkdb::testing
