#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb {

// A model's point and where it is seen, in pixels with the lens distortion in them.
struct PosePoint {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // metres, object frame
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  // The centre of a circle of this radius: `uv` is the centre of the ellipse it is seen as, which
  // is not where the circle's centre is seen. 0: a plain point. The centroid of a face is that of
  // an ellipse with the face's second moments: `radius_m` is the shorter half axis, and the squares
  // of `radius_m` and of `longer`, which points along the other, add up to that of the longer.
  double radius_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of that circle or face
  Eigen::Vector3d longer = Eigen::Vector3d::Zero();   // of a circle nothing
  double sigma_px = 1.0;                              // a residual counts in units of it
};

// A point of a model's edge and the image edge it belongs to: only the distance along the image
// edge's normal says something.
struct PoseEdge {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit
  double sigma_px = 1.0;
};

// What squared residuals say around a pose, in the unknowns (w, t): R <- exp([w]x) R and t <- t +
// dt.
struct PoseEquations {
  std::array<double, 21> H;  // J^T J, lower triangle row by row
  std::array<double, 6> g;   // J^T r
  double cost;               // sum of squares (Huber's beyond its bound), in squared sigmas

  void clear() {
    H.fill(0.0);
    g.fill(0.0);
    cost = 0.0;
  }
  Eigen::Matrix<double, 6, 6> matrix() const;
};

// Adds residuals of points or edges at a pose. Beyond `huber` sigmas a residual counts linearly
// (infinity: squared always). False where one of them is behind the camera or outside the lens
// model; what was added is then of no use.
bool add_points(std::span<const PosePoint> points,
                const Camera& camera,
                const RigidPose& pose,
                double huber,
                PoseEquations& equations);
bool add_edges(std::span<const PoseEdge> edges,
               const Camera& camera,
               const RigidPose& pose,
               double huber,
               PoseEquations& equations);

// Where a PosePoint should be seen from a pose: for a circle the centre of its ellipse, for a face
// the centre of gravity of its image (to the third order of size over distance). In rays
// (x, y at z = 1). `ok` false behind the camera.
struct SeenRay {
  Eigen::Vector2d ray;
  bool ok = false;
};
SeenRay seen_ray(const PosePoint& point, const RigidPose& pose);

}  // namespace landmarkdb
