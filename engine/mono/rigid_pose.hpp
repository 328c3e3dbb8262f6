#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// T_camera_object in the two parts that solvers work with: X = R P + t. Not initialised.
struct RigidPose {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;

  Eigen::Vector3d operator*(const Eigen::Vector3d& p_object) const { return R * p_object + t; }
  Eigen::Isometry3d isometry() const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R;
    T.translation() = t;
    return T;
  }
};

// What became of a pose computation.
enum class PoseStatus : std::uint8_t {
  kOk,
  kAmbiguous,         // two poses of a planar object explain the points about equally well
  kTooFewPoints,      // fewer than four pairs, or arrays of different lengths
  kCollinearModel,    // the model's points coincide or lie on a line
  kCollinearImage,    // so do the image's
  kBehindCamera,      // the object's origin, or a matched point, is not in front of the camera
  kOutsideLensModel,  // a pixel that no direction is seen at
  kNotFinite,
};

}  // namespace landmarkdb
