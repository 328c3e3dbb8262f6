#include "engine/servo/servo.hpp"

#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/support/servo_arms.hpp"

namespace landmarkdb {
namespace {

using testing::puma_560_pose;
using testing::wanted_pose;

ServoOptions puma_options() {
  ServoOptions options;
  options.arm = testing::puma_560(5.0);
  options.T_camera_object = wanted_pose();
  return options;
}

Eigen::Isometry3d off_by(double x_m, double turn_rad) {
  return wanted_pose() * Eigen::Translation3d(x_m, 0.0, 0.0) *
         Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
}

std::string refusal(const std::function<void(ServoOptions&)>& change) {
  ServoOptions options = puma_options();
  change(options);
  try {
    const Servo servo(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "accepted";
}

TEST(ServoOptions, AreRefusedByTheNameOfWhatIsWrong) {
  EXPECT_EQ(refusal([](ServoOptions&) {}), "accepted");
  EXPECT_THAT(refusal([](ServoOptions& o) { o.gain_per_s = 0.0; }),
              ::testing::HasSubstr("gain is 0, want a positive number"));
  EXPECT_THAT(refusal([](ServoOptions& o) { o.cycle_s = -1.0; }),
              ::testing::HasSubstr("cycle_s is -1"));
  EXPECT_THAT(refusal([](ServoOptions& o) { o.delay_cycles = 51; }),
              ::testing::HasSubstr("delay_cycles is 51, want at most 50"));
  EXPECT_THAT(refusal([](ServoOptions& o) { o.observer_memory = 1.0; }),
              ::testing::HasSubstr("observer_memory is 1"));
  EXPECT_THAT(refusal([](ServoOptions& o) { o.secondary[0].margin = 0.6; }),
              ::testing::HasSubstr("margin of joint limits is 0.6"));
  EXPECT_THAT(refusal([](ServoOptions& o) { o.secondary.assign(17, SecondaryTask{}); }),
              ::testing::HasSubstr("secondary tasks is 17"));
  EXPECT_THAT(
      refusal([](ServoOptions& o) {
        o.secondary = {{.kind = SecondaryKind::kPosture, .joints = {6}, .posture_rad = {0}}};
      }),
      ::testing::HasSubstr("a joint of a posture is 7"));
  EXPECT_THAT(refusal([](ServoOptions& o) {
                o.secondary = {{.kind = SecondaryKind::kPosture, .joints = {1}}};
              }),
              ::testing::HasSubstr("1 joints and 0 angles"));
  EXPECT_THAT(refusal([](ServoOptions& o) {
                o.T_camera_object.translation().x() = std::numeric_limits<double>::quiet_NaN();
              }),
              ::testing::HasSubstr("wanted T_camera_object"));
}

TEST(ServoOptions, WithAGainTooHighForTheCycleAreRefusedWithTheHighestThatIsNot) {
  EXPECT_THAT(
      refusal([](ServoOptions& o) { o.gain_per_s = 12.5; }),
      ::testing::HasSubstr("want below 1, or the arm swings about its goal: a gain below 12.5"));
  EXPECT_EQ(refusal([](ServoOptions& o) { o.gain_per_s = 12.4; }), "accepted");
}

TEST(Servo, HoldsTheTwistForOneCycleWithoutAMeasurementAndThenStops) {
  Servo servo(puma_options());
  JointVector q = puma_560_pose();
  const ServoCommand running = servo.step({.q = q, .T_camera_object = off_by(0.1, 0.2)});
  EXPECT_EQ(running.status, ServoStatus::kRunning);
  q += running.joint_rates * 0.08;
  const ServoCommand holding = servo.step({.q = q});
  EXPECT_EQ(holding.status, ServoStatus::kHolding);
  EXPECT_LT((holding.twist - running.twist).norm(), 1e-9) << "the same twist from another pose";
  for (int k = 0; k < 3; ++k) {
    const ServoCommand stopped = servo.step({.q = q});
    EXPECT_EQ(stopped.status, ServoStatus::kStopped);
    EXPECT_EQ(stopped.joint_rates.norm(), 0.0);
    EXPECT_EQ(stopped.joint_rates.size(), 6);
  }
  const ServoCommand again = servo.step({.q = q, .T_camera_object = off_by(0.1, 0.2)});
  EXPECT_EQ(again.status, ServoStatus::kRunning);
  EXPECT_GT(again.joint_rates.norm(), 0.01);
}

TEST(Servo, StandsStillBeforeTheFirstMeasurement) {
  Servo servo(puma_options());
  const ServoCommand command = servo.step({.q = puma_560_pose()});
  EXPECT_EQ(command.status, ServoStatus::kStopped);
  EXPECT_EQ(command.joint_rates.norm(), 0.0);
  EXPECT_FALSE(servo.goal().has_value());
}

TEST(Servo, StaysWhereItIsAtTheGoal) {
  Servo servo(puma_options());
  const ServoCommand command = servo.step({.q = puma_560_pose(), .T_camera_object = wanted_pose()});
  EXPECT_EQ(command.rank, 6);
  EXPECT_LT(command.joint_rates.norm(), 1e-9);
  EXPECT_LT(command.twist.norm(), 1e-9);
}

TEST(Servo, RefusesWhatIsNotFiniteAndCarriesOn) {
  Servo servo(puma_options());
  const JointVector q = puma_560_pose();
  Eigen::Isometry3d T = wanted_pose();
  T.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(servo.step({.q = q, .T_camera_object = T}), Error);
  EXPECT_THROW(servo.step({.q = JointVector::Zero(7), .T_camera_object = wanted_pose()}), Error);
  EXPECT_THROW(servo.step({.q = q, .q_at_image = JointVector::Zero(1)}), Error);
  EXPECT_EQ(servo.step({.q = q, .T_camera_object = wanted_pose()}).status, ServoStatus::kRunning);
}

TEST(Servo, TakesTheJointsAtTheImageFromTheCallerWhereGiven) {
  // The arm has moved on since; carried forward, it stands at the goal.
  const ServoOptions options = puma_options();
  Servo servo(options);
  const JointVector q_at_image = puma_560_pose();
  JointVector q = q_at_image;
  q(0) += 0.1;
  const Eigen::Isometry3d T_base_object = camera_pose(options.arm, q) * wanted_pose();
  const ServoCommand command =
      servo.step({.q = q,
                  .T_camera_object = camera_pose(options.arm, q_at_image).inverse() * T_base_object,
                  .q_at_image = q_at_image});
  EXPECT_LT(command.translation_m, 1e-9);
  EXPECT_LT(command.rotation_rad, 1e-7);
}

TEST(Servo, KeepsItsSymmetricGoalWhenTheMeasuredTwinJumps) {
  ServoOptions options = puma_options();
  options.symmetry = parse_servo_symmetry("c4");
  Servo servo(options);
  const JointVector q = puma_560_pose();
  const ServoCommand first = servo.step({.q = q, .T_camera_object = off_by(0.0, 1.3)});
  EXPECT_NEAR(first.rotation_rad, std::numbers::pi / 2 - 1.3, 1e-9);
  for (int k = 1; k < 4; ++k) {
    const ServoCommand twin =
        servo.step({.q = q, .T_camera_object = off_by(0.0, 1.3 + k * std::numbers::pi / 2)});
    EXPECT_LT((twin.joint_rates - first.joint_rates).norm(), 1e-9) << k;
  }
  EXPECT_THAT(*servo.goal(), testing::PoseNear(off_by(0.0, std::numbers::pi / 2), 1e-9, 1e-9));
}

TEST(Servo, SeesNoMotionInATurnThatCannotBeSeen) {
  for (const char* symmetry : {"c4", "revolution", "sphere"}) {
    ServoOptions options = puma_options();
    options.symmetry = parse_servo_symmetry(symmetry);
    options.feed_forward = true;
    options.secondary.clear();
    Servo servo(options);
    const JointVector q = puma_560_pose();
    ServoCommand command;
    for (int k = 0; k < 5; ++k) {
      const double turn = std::string(symmetry) == "c4" ? k * std::numbers::pi / 2 : 0.7 * k;
      command = servo.step({.q = q, .T_camera_object = off_by(0.0, turn)});
    }
    EXPECT_LT(command.joint_rates.norm(), 1e-9) << symmetry;
  }
}

TEST(Servo, MovesToItsPostureWhereTheTaskLeavesItFree) {
  ServoOptions options = puma_options();
  options.symmetry = parse_servo_symmetry("sphere");
  options.secondary = {
      {.kind = SecondaryKind::kPosture, .gain_per_s = 2.0, .joints = {3}, .posture_rad = {0.5}}};
  Servo servo(options);
  JointVector q = puma_560_pose();
  const Eigen::Isometry3d T_base_object = camera_pose(options.arm, q) * wanted_pose();
  for (int k = 0; k < 300; ++k) {
    const ServoCommand command = servo.step(
        {.q = q, .T_camera_object = camera_pose(options.arm, q).inverse() * T_base_object});
    ASSERT_LT(command.translation_m, 5e-3) << "while the main task is kept, cycle " << k;
    q += command.joint_rates * options.cycle_s;
  }
  EXPECT_NEAR(q(3), 0.5, 1e-3);
}

TEST(ServoStatus, HasNames) {
  EXPECT_EQ(to_string(ServoStatus::kRunning), "running");
  EXPECT_EQ(to_string(ServoStatus::kHolding), "holding");
  EXPECT_EQ(to_string(ServoStatus::kStopped), "stopped");
}

}  // namespace
}  // namespace landmarkdb
