#include "engine/servo/task.hpp"

#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/support/servo_arms.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
using testing::wanted_pose;

// T_camera_object after the camera has moved by `twist` for a unit of time, in its own frame.
Eigen::Isometry3d seen_after(const Eigen::Isometry3d& T_camera_object,
                             const Eigen::Matrix<double, 6, 1>& twist) {
  Eigen::Isometry3d T_before_after = Eigen::Isometry3d::Identity();
  T_before_after.linear() = rotation_from_vector(twist.tail<3>());
  T_before_after.translation() = twist.head<3>();
  return T_before_after.inverse() * T_camera_object;
}

Eigen::Isometry3d random_pose_near(Random& random, double angle_rad) {
  const Eigen::Vector3d axis =
      Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
  off.linear() = rotation_from_vector(angle_rad * axis);
  off.translation() = 0.3 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  return off * wanted_pose();
}

TEST(TaskError, HasAnInteractionMatrixThatEqualsFiniteDifferences) {
  Random random(2);
  constexpr double kStep = 1e-5;
  for (const char* name : {"none", "c4", "revolution", "sphere"}) {
    const ServoSymmetry symmetry = parse_servo_symmetry(name);
    for (const double angle : {0.0, 1e-6, 1e-3, 2e-3, 0.1, 1.0, 2.0, 2.9}) {
      for (int trial = 0; trial < 20; ++trial) {
        const Eigen::Isometry3d T = random_pose_near(random, angle);
        const TaskError task = task_error(T, wanted_pose(), symmetry);
        for (int k = 0; k < 6; ++k) {
          const Eigen::Matrix<double, 6, 1> step = Eigen::Matrix<double, 6, 1>::Unit(k) * kStep;
          const Eigen::VectorXd difference =
              (task_error(seen_after(T, step), wanted_pose(), symmetry).e -
               task_error(seen_after(T, -step), wanted_pose(), symmetry).e) /
              (2.0 * kStep);
          // The turn's second derivative grows without bound towards pi.
          const double tolerance = angle > 2.5 ? 1e-5 : 1e-6;
          EXPECT_LT((task.L.col(k) - difference).cwiseAbs().maxCoeff(), tolerance)
              << name << " at " << angle << " rad, column " << k;
        }
      }
    }
  }
}

TEST(TaskError, IsZeroAtTheGoalAndWhereSymmetryMakesNoDifference) {
  const auto size = [](const Eigen::Isometry3d& T, const char* name) {
    return task_error(T, wanted_pose(), parse_servo_symmetry(name)).e.norm();
  };
  const Eigen::Isometry3d about_z =
      wanted_pose() * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
  const Eigen::Isometry3d about_x =
      wanted_pose() * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX());
  for (const char* name : {"none", "revolution", "sphere"}) {
    EXPECT_LT(size(wanted_pose(), name), 1e-12) << name;
  }
  EXPECT_NEAR(size(about_z, "none"), std::hypot(1.0, 0.0), 1e-9);
  EXPECT_LT(size(about_z, "revolution"), 1e-12);
  EXPECT_NEAR(size(about_x, "revolution"), 1.0, 1e-9);
  EXPECT_LT(size(about_x, "sphere"), 1e-12);
}

TEST(TaskError, HasAsManyRowsAsFreedomsItFixes) {
  const auto rows = [](const char* name) {
    return task_error(wanted_pose(), wanted_pose(), parse_servo_symmetry(name)).L.rows();
  };
  EXPECT_EQ(rows("none"), 6);
  EXPECT_EQ(rows("c4"), 6);
  EXPECT_EQ(rows("revolution"), 5);
  EXPECT_EQ(rows("sphere"), 3);
}

TEST(TaskError, IsFiniteForHalfATurn) {
  for (const char* name : {"none", "revolution"}) {
    const Eigen::Isometry3d T =
        wanted_pose() * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
    const TaskError task = task_error(T, wanted_pose(), parse_servo_symmetry(name));
    EXPECT_TRUE(task.e.allFinite() && task.L.allFinite()) << name;
    EXPECT_NEAR(task.rotation_rad, std::numbers::pi, 1e-9) << name;
  }
}

TEST(TaskError, MeasuresTheStartOfThePuma560Run) {
  const Arm arm = testing::puma_560(1.0);
  JointVector q = testing::puma_560_pose();
  const Eigen::Isometry3d T_base_object = camera_pose(arm, q) * wanted_pose();
  JointVector away(6);
  away << 0.25, -0.2, 0.25, 0.3, -0.3, 0.5;
  q += away;
  const Eigen::Isometry3d T_camera_object = camera_pose(arm, q).inverse() * T_base_object;
  const Eigen::Vector3d p(-0.315371283, 0.057999286, 0.492460488);
  EXPECT_LT((T_camera_object.translation() - p).cwiseAbs().maxCoeff(), 1e-9);
  const TaskError task = task_error(T_camera_object, wanted_pose(), {});
  EXPECT_NEAR(task.translation_m, 0.228063944, 1e-9);
  EXPECT_NEAR(task.rotation_rad / kDegree, 44.44061, 2e-6);
  EXPECT_NEAR(task.rotation_rad,
              rotation_angle_rad(T_camera_object.linear() * wanted_pose().linear().transpose()),
              1e-12);
}

TEST(ChooseSymmetricGoal, TakesTheNearestTurnAboutTheAxis) {
  const auto chosen_deg = [](const char* name, double object_deg) {
    const Eigen::Isometry3d T =
        wanted_pose() * Eigen::AngleAxisd(object_deg * kDegree, Eigen::Vector3d::UnitZ());
    const Eigen::Isometry3d goal =
        choose_symmetric_goal(T, wanted_pose(), parse_servo_symmetry(name));
    return rotation_vector(wanted_pose().linear().transpose() * goal.linear()).z() / kDegree;
  };
  EXPECT_NEAR(chosen_deg("c4", 80.0), 90.0, 1e-9);
  EXPECT_NEAR(chosen_deg("c4", -50.0), -90.0, 1e-9);
  EXPECT_NEAR(chosen_deg("c4", 44.0), 0.0, 1e-9);
  EXPECT_NEAR(chosen_deg("c3", 100.0), 120.0, 1e-9);
  EXPECT_NEAR(chosen_deg("c360", 17.3), 17.0, 1e-9);
  EXPECT_NEAR(chosen_deg("none", 80.0), 0.0, 1e-9);
  EXPECT_NEAR(chosen_deg("c2", 90.0), 0.0, 1e-9) << "a tie goes to the smaller turn";
}

TEST(ParseServoSymmetry, ReadsWhatItWrites) {
  for (const char* name : {"none", "c2", "c4", "c17", "revolution", "sphere"}) {
    EXPECT_EQ(to_string(parse_servo_symmetry(name)), name);
  }
  for (const char* name :
       {"", "c", "c1", "c0", "c361", "c4x", "c-4", "C4", "box", "c99999999999"}) {
    EXPECT_THROW(parse_servo_symmetry(name), Error) << name;
  }
}

TEST(RotationVector, IsTheInverseOfRotationFromVector) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d axis =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Vector3d w = axis * random.uniform(0.0, 3.14);
    EXPECT_LT((rotation_vector(rotation_from_vector(w)) - w).norm(), 1e-9);
  }
  EXPECT_EQ(rotation_vector(Eigen::Matrix3d::Identity()).norm(), 0.0);
  EXPECT_LT(
      (rotation_vector(rotation_from_vector({1e-9, 0, 0})) - Eigen::Vector3d(1e-9, 0, 0)).norm(),
      1e-20);
}

}  // namespace
}  // namespace landmarkdb
