// A simulated arm, its camera's rendered images, recognition, tracking and the control law: the
// whole loop, with images that are a cycle old when they count.

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "datasets/mono/render_model.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/mono/tracker.hpp"
#include "engine/servo/servo.hpp"
#include "tests/support/servo_arms.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
using testing::box_record;

// Half a metre in front of the camera, three sides of the box in view.
Eigen::Isometry3d wanted() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector({0.9, 0.5, 0.2});
  T.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
  return T;
}

struct Outcome {
  std::optional<int> arrived{};       // first cycle whose true error is below 1 mm and 0.1 deg
  double rms_m = 0.0, rms_rad = 0.0;  // true error over the last cycles
  int unmeasured = 0;                 // cycles without a measured pose
};

Outcome run_loop(const Arm& arm, const JointVector& q_goal, const JointVector& away) {
  auto catalog = std::make_shared<MonoCatalog>();
  catalog->entries.push_back({.model_id = 1, .record = box_record()});
  const Recognizer recognizer(catalog);
  const Camera camera = testing::arm_camera();
  Tracker tracker(box_record(), camera, {}, &recognizer);
  ServoOptions options;
  options.arm = arm;
  options.T_camera_object = wanted();
  options.gain_per_s = 3.0;
  options.delay_cycles = 1;
  Servo servo(options);
  const Eigen::Isometry3d T_base_object = camera_pose(arm, q_goal) * wanted();
  JointVector q = q_goal + away;
  std::optional<Eigen::Isometry3d> measured;
  Outcome outcome;
  constexpr int kCycles = 70;
  constexpr int kSettled = 50;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    const Eigen::Isometry3d T = camera_pose(arm, q).inverse() * T_base_object;
    const TaskError truth = task_error(T, wanted(), {});
    if (!outcome.arrived && truth.translation_m < 1e-3 && truth.rotation_rad < 0.1 * kDegree) {
      outcome.arrived = cycle;
    }
    if (cycle >= kSettled) {
      outcome.rms_m += truth.translation_m * truth.translation_m / (kCycles - kSettled);
      outcome.rms_rad += truth.rotation_rad * truth.rotation_rad / (kCycles - kSettled);
    }
    // What is measured in this image arrives in the next cycle.
    const ServoCommand command = servo.step({.q = q, .T_camera_object = measured});
    const GreyImage image = datasets::render_model(
        box_record()->model,
        camera,
        T,
        {.noise = 2.0, .clutter = 6, .samples = 3, .seed = static_cast<std::uint64_t>(7)});
    const TrackResult seen = tracker.next(image, {});
    measured = seen.measured() ? seen.T_camera_object : std::nullopt;
    outcome.unmeasured += measured ? 0 : 1;
    q += command.joint_rates * options.cycle_s;
  }
  outcome.rms_m = std::sqrt(outcome.rms_m);
  outcome.rms_rad = std::sqrt(outcome.rms_rad);
  return outcome;
}

void expect_arrival(const Outcome& outcome) {
  ::testing::Test::RecordProperty("rms_mm", std::to_string(1e3 * outcome.rms_m));
  ::testing::Test::RecordProperty("rms_deg", std::to_string(outcome.rms_rad / kDegree));
  ::testing::Test::RecordProperty("arrived", outcome.arrived.value_or(-1));
  ASSERT_TRUE(outcome.arrived.has_value());
  EXPECT_LE(*outcome.arrived, 40);
  EXPECT_LT(outcome.rms_m, 1e-3);
  EXPECT_LT(outcome.rms_rad, 0.1 * kDegree);
  EXPECT_LE(outcome.unmeasured, 2);
}

JointVector away(double share) {
  JointVector q(6);
  q << 0.12, -0.10, 0.12, 0.15, -0.15, 0.5;
  return share * q;
}

TEST(ClosedLoop, LeadsAPuma560HomeByWhatItsCameraRecognises) {
  expect_arrival(run_loop(testing::puma_560(3.0), testing::puma_560_pose(), away(1.0)));
}

TEST(ClosedLoop, LeadsASmallArmHomeByWhatItsCameraRecognises) {
  expect_arrival(run_loop(testing::small_arm(3.0), testing::small_arm_pose(), away(0.8)));
}

}  // namespace
}  // namespace landmarkdb
