#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb {

// Start poses by scaled orthography with perspective correction (DeMenthon and Davis 1995; for
// planar points Oberkampf, DeMenthon and Davis 1996, whose two branches the closed form gives).
//
// `xyz` in metres, `rays` x, y at z = 1 without lens distortion; at least four pairs. One pose, two
// for planar points. Cost: below a microsecond for ten points.
struct StartPoses {
  PoseStatus status = PoseStatus::kNotFinite;
  bool planar = false;
  int count = 0;
  std::array<RigidPose, 2> poses;
};
StartPoses start_poses(std::span<const Eigen::Vector3d> xyz,
                       std::span<const Eigen::Vector2d> rays,
                       bool as_plane = false);

struct PointPoseOptions {
  double huber = 0.0;  // sigmas beyond which a residual counts linearly; 0: never
  double sigma_px =
      0.5;  // of a pixel coordinate, where it decides whether two poses can be told apart
};

struct PointPose {
  RigidPose pose;
  double cost = 0.0;    // sum of squared residuals in sigmas of the points
  double rms_px = 0.0;  // of the points' distances
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  // see pose_covariance
};

// The better pose first. Two only for kAmbiguous: two poses of a planar object of which the other's
// residuals are below twice the best's, or which the noise cannot tell apart.
struct PointPoses {
  PoseStatus status = PoseStatus::kNotFinite;
  int count = 0;
  std::array<PointPose, 2> poses{};
};

// The pose of four or more points that minimises their squared distances in the image, with the
// lens model; no start is needed. Two thousand nanoseconds for ten points.
PointPoses solve_points(std::span<const PosePoint> points,
                        const Camera& camera,
                        const PointPoseOptions& options);

// The same minimum from a pose that is known roughly. kBehindCamera where a point is not seen from
// the start or the end.
PointPoses refine_points(std::span<const PosePoint> points,
                         const Camera& camera,
                         const RigidPose& start,
                         const PointPoseOptions& options);

}  // namespace landmarkdb
