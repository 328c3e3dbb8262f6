#include "engine/servo/arm.hpp"

#include <cassert>
#include <cmath>
#include <sstream>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMostJoints = 32;  // snake-like arms have some 20

Eigen::Isometry3d link(const ArmJoint& joint, double q) {
  const double theta = q + joint.offset_rad;
  const double ct = std::cos(theta);
  const double st = std::sin(theta);
  const double ca = std::cos(joint.alpha_rad);
  const double sa = std::sin(joint.alpha_rad);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << ct, -st * ca, st * sa, st, ct * ca, -ct * sa, 0.0, sa, ca;
  T.translation() << joint.a_m * ct, joint.a_m * st, joint.d_m;
  return T;
}

[[noreturn]] void refuse(std::size_t joint, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, "joint " + std::to_string(joint + 1) + ": " + what);
}

}  // namespace

std::vector<Eigen::Isometry3d> link_poses(const Arm& arm, const JointVector& q) {
  assert(static_cast<std::size_t>(q.size()) == arm.joints.size() && "one angle a joint");
  std::vector<Eigen::Isometry3d> poses(arm.joints.size() + 1, Eigen::Isometry3d::Identity());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    poses[i + 1] = poses[i] * link(arm.joints[i], q(static_cast<Eigen::Index>(i)));
  }
  return poses;
}

Eigen::Isometry3d camera_pose(const Arm& arm, const JointVector& q) {
  return link_poses(arm, q).back() * arm.T_flange_camera;
}

CameraJacobian camera_jacobian(const Arm& arm, const JointVector& q) {
  const std::vector<Eigen::Isometry3d> T_base = link_poses(arm, q);
  const Eigen::Isometry3d T_base_camera = T_base.back() * arm.T_flange_camera;
  const Eigen::Matrix3d R_camera_base = T_base_camera.linear().transpose();
  CameraJacobian J(6, q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    // Joint i turns about the z axis of the frame before it.
    const Eigen::Isometry3d& frame = T_base[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = frame.linear().col(2);
    const Eigen::Vector3d arm_m = T_base_camera.translation() - frame.translation();
    J.col(i).head<3>() = R_camera_base * axis.cross(arm_m);
    J.col(i).tail<3>() = R_camera_base * axis;
  }
  return J;
}

void check_arm(const Arm& arm) {
  if (arm.joints.empty() || arm.joints.size() > kMostJoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "an arm has " + std::to_string(arm.joints.size()) + " joints, want 1 to " +
                    std::to_string(kMostJoints));
  }
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const ArmJoint& joint = arm.joints[i];
    if (!std::isfinite(joint.a_m) || !std::isfinite(joint.alpha_rad) || !std::isfinite(joint.d_m) ||
        !std::isfinite(joint.offset_rad)) {
      refuse(i, "a, alpha, d or offset is not finite");
    }
    if (!(joint.min_rad < joint.max_rad)) {
      std::ostringstream message;
      message << "its range is " << joint.min_rad << " to " << joint.max_rad
              << " rad, want min below max";
      refuse(i, message.str());
    }
    if (!(joint.max_rate_rad_s > 0.0)) {
      std::ostringstream message;
      message << "its largest rate is " << joint.max_rate_rad_s << " rad/s, want it positive";
      refuse(i, message.str());
    }
  }
  if (!arm.T_flange_camera.matrix().allFinite()) {
    throw Error(ErrorCode::kInvalidArgument, "T_flange_camera has a number that is not finite");
  }
}

void check_joint_angles(const Arm& arm, const JointVector& q) {
  if (static_cast<std::size_t>(q.size()) != arm.joints.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(q.size()) + " joint angles, want one for each of the arm's " +
                    std::to_string(arm.joints.size()) + " joints");
  }
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!std::isfinite(q(i))) refuse(static_cast<std::size_t>(i), "its angle is not finite");
  }
}

}  // namespace landmarkdb
