#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// One revolute joint and the link behind it, in the standard notation of Denavit & Hartenberg
// (1955): T_(i-1)_i = Rz(q + offset) Tz(d) Tx(a) Rx(alpha).
struct ArmJoint {
  double a_m = 0.0;
  double alpha_rad = 0.0;
  double d_m = 0.0;
  double offset_rad = 0.0;  // of theta when the joint reads zero
  double min_rad = -std::numeric_limits<double>::infinity();
  double max_rad = std::numeric_limits<double>::infinity();
  double max_rate_rad_s = std::numeric_limits<double>::infinity();
};

// An arm with a camera in its hand.
struct Arm {
  std::vector<ArmJoint> joints{};
  Eigen::Isometry3d T_flange_camera = Eigen::Isometry3d::Identity();  // the hand-eye transform
};

using JointVector = Eigen::VectorXd;  // one number a joint
using CameraJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Where each joint's frame is: T_base_0 (identity) to T_base_n (the flange), n + 1 of them.
// `q`: one angle a joint, radians.
std::vector<Eigen::Isometry3d> link_poses(const Arm& arm, const JointVector& q);

// T_base_camera at joint angles `q`.
Eigen::Isometry3d camera_pose(const Arm& arm, const JointVector& q);

// The camera's twist (v, omega), in the camera frame, is this times the joint rates.
CameraJacobian camera_jacobian(const Arm& arm, const JointVector& q);

// Throws Error{kInvalidArgument} that names the joint when a number is not finite, a range is empty
// or a rate is not positive, and for an arm of no joint or more than 32.
void check_arm(const Arm& arm);

// Throws Error{kInvalidArgument} unless `q` has one finite angle a joint. Angles past a limit pass:
// a real arm's sensors report such.
void check_joint_angles(const Arm& arm, const JointVector& q);

}  // namespace landmarkdb
