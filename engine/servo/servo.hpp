#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/servo/arm.hpp"
#include "engine/servo/solve.hpp"
#include "engine/servo/target_observer.hpp"
#include "engine/servo/task.hpp"

namespace landmarkdb {

// What the arm does with the freedom that the main task leaves.
enum class SecondaryKind {
  kJointLimits,  // keep out of the outer `margin` of each joint's range
  kPosture       // come near the angles given
};
struct SecondaryTask {
  SecondaryKind kind = SecondaryKind::kJointLimits;
  double gain_per_s = 20.0;
  double margin = 0.1;                 // kJointLimits: share of the range, at each end
  std::vector<Eigen::Index> joints{};  // kPosture: which joints,
  std::vector<double> posture_rad{};   // and where they should be
};

// Everything the control law is told once.
struct ServoOptions {
  Arm arm{};
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();  // wanted
  ServoSymmetry symmetry{};
  double gain_per_s = 3.0;       // lambda
  double cycle_s = 0.08;         // Te; gain times cycle below 1, or the loop swings
  std::size_t delay_cycles = 0;  // how many cycles old a measurement is when it arrives
  std::size_t hold_cycles = 1;   // without a measurement: hold the twist so long, then stop
  bool feed_forward = false;     // add the target's own velocity, observed
  double observer_memory = 0.8;  // of that observer, 0 to below 1
  std::vector<SecondaryTask> secondary{SecondaryTask{}};  // most important first
  PseudoInverseOptions inverse{};
};

// Throws Error{kInvalidArgument} naming the option, what was seen and what was wanted.
void check_servo_options(const ServoOptions& options);

enum class ServoStatus {
  kRunning,
  kHolding,  // no measurement: the last twist goes on
  kStopped   // none for longer: all rates are zero
};
std::string_view to_string(ServoStatus status);

struct ServoInput {
  JointVector q{};                                     // now, rad
  std::optional<Eigen::Isometry3d> T_camera_object{};  // measured; none: the object was not seen
  // The joints when the image was taken, where the caller knows them; otherwise those of
  // `delay_cycles` cycles ago.
  std::optional<JointVector> q_at_image{};
};

struct ServoCommand {
  ServoStatus status = ServoStatus::kStopped;
  Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();  // what the rates give
  JointVector joint_rates{};                                                // rad/s
  Eigen::VectorXd error{};     // the task function; empty when not running
  double translation_m = 0.0;  // its size
  double rotation_rad = 0.0;
  int rank = 0;
  double smallest_singular = 0.0;
  bool damped = false;                   // near a singular pose of the arm
  double rate_scale = 1.0;               // below 1: a joint would have been too fast
  std::vector<Eigen::Index> at_limit{};  // joints clamped at a limit, ascending
};

// The control law of an eye-in-hand arm (position-based visual servoing).
//
//   q_rate = J^+ (-gain e + L xi_target) + free motion,   J = L J_camera
//
// One step a cycle of `cycle_s`. A measurement is carried to the arm's present pose by its
// kinematics, and by the target's velocity where feed-forward is on. Of a cyclic object, the goal
// nearest to the first measurement is kept, and later measurements that are the same pose turned by
// its symmetry are turned back. Not thread-safe; no allocation limits are needed, as its history
// has delay_cycles + 1 entries.
class Servo {
 public:
  // Throws as check_servo_options.
  explicit Servo(ServoOptions options);

  // Throws Error{kInvalidArgument} for joint angles or a pose that are not finite or of the wrong
  // number; the state is then as before.
  ServoCommand step(const ServoInput& input);

  const ServoOptions& options() const { return options_; }
  // The goal among its symmetric twins; none before the first measurement.
  const std::optional<Eigen::Isometry3d>& goal() const { return goal_; }

 private:
  Eigen::Isometry3d locate(const Eigen::Isometry3d& T_camera_object,
                           const Eigen::Isometry3d& T_base_camera);
  Eigen::Matrix<double, 6, 1> target_twist(const Eigen::Isometry3d& T_base_camera,
                                           const Eigen::Isometry3d& T_base_object) const;
  std::vector<JointTask> joint_tasks(const JointVector& q) const;
  ServoCommand follow(const ServoInput& input, const JointVector& q_at_image);
  ServoCommand coast(const JointVector& q);

  ServoOptions options_;
  TargetObserver observer_;
  std::deque<JointVector> history_;
  std::optional<Eigen::Isometry3d> goal_;
  std::optional<Eigen::Isometry3d> T_base_object_;  // as last measured
  std::optional<Eigen::Matrix<double, 6, 1>> last_twist_;
  std::size_t cycles_unseen_ = 0;
};

}  // namespace landmarkdb
