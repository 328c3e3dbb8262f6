#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/registration/plane_layout.hpp"

namespace landmarkdb::testing {

inline constexpr double kBin_m = 0.1;

// Rectangles that make a room, for what lays planes on planes.
struct PlaneSurface {
  std::vector<Eigen::Vector3f> points, normals;

  // A rectangle with two edges, points every 5 cm, facing along u x v.
  void add(const Eigen::Vector3f& corner, const Eigen::Vector3f& u, const Eigen::Vector3f& v) {
    constexpr float kStep_m = 0.05F;
    const Eigen::Vector3f normal = u.cross(v).normalized();
    for (float a = 0.0F; a <= u.norm(); a += kStep_m) {
      for (float b = 0.0F; b <= v.norm(); b += kStep_m) {
        points.push_back(corner + a * u.normalized() + b * v.normalized());
        normals.push_back(normal);
      }
    }
  }
  PlaneSurface moved(const Eigen::Isometry3d& T) const {
    PlaneSurface surface;
    for (const auto& p : points) surface.points.push_back((T * p.cast<double>()).cast<float>());
    for (const auto& n : normals) {
      surface.normals.push_back((T.linear() * n.cast<double>()).cast<float>());
    }
    return surface;
  }
  Eigen::Vector3f centre() const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const auto& p : points) sum += p;
    return sum / static_cast<float>(points.size());
  }
  std::vector<PlaneLayout> layouts(std::size_t most = 1) const {
    return lay_out_planes(points, normals, kBin_m, most);
  }
};

// A room of 8 x 5 x 3 m seen from inside, with a step in one wall, and what a camera sees of it.
inline PlaneSurface room() {
  PlaneSurface surface;
  surface.add({0, 0, 0}, {8, 0, 0}, {0, 5, 0});
  surface.add({0, 0, 0}, {0, 5, 0}, {0, 0, 3});
  surface.add({0, 0, 0}, {0, 0, 3}, {8, 0, 0});
  surface.add({8, 0, 0}, {0, 0, 3}, {0, 5, 0});
  surface.add({0, 5, 0}, {5, 0, 0}, {0, 0, 3});
  surface.add({5, 4, 0}, {3, 0, 0}, {0, 0, 3});
  return surface;
}

inline PlaneSurface corner_of_room() {
  PlaneSurface surface;
  surface.add({5, 1, 0}, {3, 0, 0}, {0, 3, 0});
  surface.add({8, 1, 0}, {0, 0, 2}, {0, 3, 0});
  surface.add({5.5F, 4, 0}, {2.5F, 0, 0}, {0, 0, 2});
  return surface;
}

inline Eigen::Isometry3d random_pose(Random& random) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  T.linear() =
      Eigen::AngleAxisd(random.uniform(0, std::numbers::pi), axis.normalized()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  return T;
}

}  // namespace landmarkdb::testing
