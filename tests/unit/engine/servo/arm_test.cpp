#include "engine/servo/arm.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/servo/task.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/support/servo_arms.hpp"

namespace landmarkdb {
namespace {

using testing::puma_560;
using testing::puma_560_pose;
using testing::small_arm;

TEST(LinkPoses, PutTheFlangeOfAPuma560WhereItsTableSays) {
  Eigen::Matrix4d flange;
  flange << 0.258819045, 0, 0.965925826, 0.596303149, 0, 1, 0, -0.15005, -0.965925826, 0,
      0.258819045, -0.014354268, 0, 0, 0, 1;
  const Eigen::Matrix4d seen = link_poses(puma_560(1.0), puma_560_pose()).back().matrix();
  EXPECT_LT((seen - flange).cwiseAbs().maxCoeff(), 1e-9) << seen;
}

TEST(LinkPoses, AddTheOffsetOfAJointToItsAngle) {
  Arm arm = puma_560(1.0);
  JointVector q = puma_560_pose();
  const Eigen::Isometry3d before = camera_pose(arm, q);
  arm.joints[2].offset_rad = 0.7;
  q(2) -= 0.7;
  EXPECT_THAT(camera_pose(arm, q), testing::PoseNear(before, 1e-12, 1e-12));
}

TEST(CameraPose, IsTheFlangeTimesTheHandEyeTransform) {
  const Arm arm = small_arm(1.0);
  const JointVector q = testing::small_arm_pose();
  const Eigen::Isometry3d expected = link_poses(arm, q).back() * arm.T_flange_camera;
  EXPECT_THAT(camera_pose(arm, q), testing::PoseNear(expected, 1e-15, 1e-15));
  EXPECT_GT((link_poses(arm, q).back().translation() - expected.translation()).norm(), 0.09);
}

// Twist of the camera in its own frame, by central differences of the pose.
Eigen::Matrix<double, 6, 1> twist_by_difference(const Arm& arm,
                                                const JointVector& q,
                                                Eigen::Index joint) {
  constexpr double kStep = 1e-5;
  const JointVector step = JointVector::Unit(q.size(), joint) * kStep;
  const Eigen::Isometry3d before = camera_pose(arm, q - step);
  const Eigen::Isometry3d after = camera_pose(arm, q + step);
  const Eigen::Matrix3d R = camera_pose(arm, q).linear();
  Eigen::Matrix<double, 6, 1> twist;
  twist.head<3>() = R.transpose() * (after.translation() - before.translation()) / (2.0 * kStep);
  twist.tail<3>() = rotation_vector(before.linear().transpose() * after.linear()) / (2.0 * kStep);
  return twist;
}

TEST(CameraJacobian, EqualsFiniteDifferences) {
  Random random(1);
  for (const Arm& arm : {puma_560(1.0), small_arm(1.0)}) {
    for (int trial = 0; trial < 200; ++trial) {
      JointVector q(6);
      for (Eigen::Index i = 0; i < 6; ++i) q(i) = random.uniform(-3.0, 3.0);
      const CameraJacobian J = camera_jacobian(arm, q);
      for (Eigen::Index i = 0; i < 6; ++i) {
        EXPECT_LT((J.col(i) - twist_by_difference(arm, q, i)).cwiseAbs().maxCoeff(), 1e-6);
      }
    }
  }
}

std::string refusal(const Arm& arm) {
  try {
    check_arm(arm);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "accepted";
}

TEST(CheckArm, NamesTheJointAtFault) {
  EXPECT_EQ(refusal(puma_560(1.0)), "accepted");
  Arm arm = puma_560(1.0);
  arm.joints[2].max_rad = arm.joints[2].min_rad;
  EXPECT_THAT(refusal(arm), ::testing::HasSubstr("joint 3: its range is"));
  arm = puma_560(1.0);
  arm.joints[4].max_rate_rad_s = 0.0;
  EXPECT_THAT(refusal(arm), ::testing::HasSubstr("joint 5: its largest rate is 0"));
  arm = puma_560(1.0);
  arm.joints[0].d_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(arm), ::testing::HasSubstr("joint 1: a, alpha, d or offset"));
  EXPECT_THAT(refusal(Arm{}), ::testing::HasSubstr("0 joints, want 1 to 32"));
  arm.joints.assign(33, ArmJoint{});
  EXPECT_THAT(refusal(arm), ::testing::HasSubstr("33 joints, want 1 to 32"));
}

TEST(CheckJointAngles, WantsOneFiniteAngleAJoint) {
  const Arm arm = puma_560(1.0);
  EXPECT_NO_THROW(check_joint_angles(arm, puma_560_pose()));
  EXPECT_THROW(check_joint_angles(arm, JointVector::Zero(5)), Error);
  JointVector q = puma_560_pose();
  q(3) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check_joint_angles(arm, q), Error);
}

}  // namespace
}  // namespace landmarkdb
