#include "engine/servo/servo.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

using Twist = Eigen::Matrix<double, 6, 1>;

// A delay longer than this is no control loop (2 s at 25 images a second).
constexpr std::size_t kLongestDelay = 50;
constexpr std::size_t kMostSecondary = 16;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, what);
}

template <typename Value>
void want(bool holds, const char* name, const Value& seen, const char* wanted) {
  if (holds) return;
  std::ostringstream message;
  message << name << " is " << seen << ", want " << wanted;
  refuse(message.str());
}

void check_secondary(const SecondaryTask& task, std::size_t joints) {
  want(task.gain_per_s > 0.0 && std::isfinite(task.gain_per_s),
       "the gain of a secondary task",
       task.gain_per_s,
       "a positive number of 1/s");
  if (task.kind == SecondaryKind::kJointLimits) {
    want(task.margin > 0.0 && task.margin <= 0.5,
         "the margin of joint limits",
         task.margin,
         "a share of the range, above 0 and at most 0.5");
    return;
  }
  if (task.joints.size() != task.posture_rad.size()) {
    refuse("a posture names " + std::to_string(task.joints.size()) + " joints and " +
           std::to_string(task.posture_rad.size()) + " angles, want as many");
  }
  for (std::size_t k = 0; k < task.joints.size(); ++k) {
    want(task.joints[k] >= 0 && static_cast<std::size_t>(task.joints[k]) < joints,
         "a joint of a posture",
         task.joints[k] + 1,
         "one of the arm's, counted from 1");
    want(std::isfinite(task.posture_rad[k]),
         "an angle of a posture",
         task.posture_rad[k],
         "a finite number");
  }
}

// How far q is inside the outer `margin` of the joint's range; negative at the lower end.
double penetration_rad(const ArmJoint& joint, double q, double margin) {
  const double band = margin * (joint.max_rad - joint.min_rad);
  if (!std::isfinite(band)) return 0.0;
  if (q > joint.max_rad - band) return q - (joint.max_rad - band);
  if (q < joint.min_rad + band) return q - (joint.min_rad + band);
  return 0.0;
}

}  // namespace

void check_servo_options(const ServoOptions& options) {
  check_arm(options.arm);
  if (!options.T_camera_object.matrix().allFinite()) {
    refuse("the wanted T_camera_object has a number that is not finite");
  }
  want(options.gain_per_s > 0.0 && std::isfinite(options.gain_per_s),
       "gain",
       options.gain_per_s,
       "a positive number of 1/s");
  want(options.cycle_s > 0.0 && std::isfinite(options.cycle_s),
       "cycle_s",
       options.cycle_s,
       "a positive number of seconds");
  if (!(options.gain_per_s * options.cycle_s < 1.0)) {
    std::ostringstream message;
    message << "gain " << options.gain_per_s << " 1/s times cycle_s " << options.cycle_s << " s is "
            << options.gain_per_s * options.cycle_s
            << ", want below 1, or the arm swings about its goal: a gain below "
            << 1.0 / options.cycle_s;
    refuse(message.str());
  }
  want(options.delay_cycles <= kLongestDelay, "delay_cycles", options.delay_cycles, "at most 50");
  want(options.observer_memory >= 0.0 && options.observer_memory < 1.0,
       "observer_memory",
       options.observer_memory,
       "0 to below 1");
  want(options.secondary.size() <= kMostSecondary,
       "the number of secondary tasks",
       options.secondary.size(),
       "at most 16");
  for (const SecondaryTask& task : options.secondary) {
    check_secondary(task, options.arm.joints.size());
  }
}

std::string_view to_string(ServoStatus status) {
  switch (status) {
    case ServoStatus::kRunning:
      return "running";
    case ServoStatus::kHolding:
      return "holding";
    case ServoStatus::kStopped:
      break;
  }
  return "stopped";
}

Servo::Servo(ServoOptions options)
    : options_(std::move(options)), observer_(options_.observer_memory) {
  check_servo_options(options_);
}

ServoCommand Servo::step(const ServoInput& input) {
  check_joint_angles(options_.arm, input.q);
  if (input.q_at_image) check_joint_angles(options_.arm, *input.q_at_image);
  if (input.T_camera_object && !input.T_camera_object->matrix().allFinite()) {
    refuse("the measured T_camera_object has a number that is not finite");
  }
  history_.push_back(input.q);
  if (history_.size() > options_.delay_cycles + 1) history_.pop_front();
  if (!input.T_camera_object) return coast(input.q);
  return follow(input, input.q_at_image ? *input.q_at_image : history_.front());
}

// T_base_object of a measurement, as the twin that continues the last one.
Eigen::Isometry3d Servo::locate(const Eigen::Isometry3d& T_camera_object,
                                const Eigen::Isometry3d& T_base_camera) {
  Eigen::Isometry3d T_base_object = T_base_camera * T_camera_object;
  if (T_base_object_) {
    // Turned about its z axis like the last one, so that the observer sees no turn in what cannot
    // be seen.
    if (options_.symmetry.kind == ServoSymmetryKind::kCyclic) {
      T_base_object = choose_symmetric_goal(*T_base_object_, T_base_object, options_.symmetry);
    } else if (options_.symmetry.kind == ServoSymmetryKind::kRevolution) {
      T_base_object.linear() =
          rotation_between(T_base_object_->linear().col(2), T_base_object.linear().col(2)) *
          T_base_object_->linear();
    } else if (options_.symmetry.kind == ServoSymmetryKind::kSphere) {
      T_base_object.linear() = T_base_object_->linear();
    }
  }
  const auto missed = static_cast<double>(cycles_unseen_ + 1);
  if (options_.feed_forward) observer_.update(T_base_object, missed * options_.cycle_s);
  T_base_object_ = T_base_object;
  return T_base_object;
}

// The camera twist that would stay with the target.
Twist Servo::target_twist(const Eigen::Isometry3d& T_base_camera,
                          const Eigen::Isometry3d& T_base_object) const {
  const Eigen::Matrix3d R_camera_base = T_base_camera.linear().transpose();
  const Eigen::Vector3d lever = T_base_camera.translation() - T_base_object.translation();
  Twist twist;
  twist.head<3>() = R_camera_base * (observer_.velocity() + observer_.turn_rate().cross(lever));
  twist.tail<3>() = R_camera_base * observer_.turn_rate();
  return twist;
}

std::vector<JointTask> Servo::joint_tasks(const JointVector& q) const {
  std::vector<JointTask> tasks;
  for (const SecondaryTask& secondary : options_.secondary) {
    // Whatever the gain, one cycle goes half of the way at the most: more would overshoot, as the
    // main task moves the joints at the same time.
    const double gain = std::min(secondary.gain_per_s, 0.5 / options_.cycle_s);
    JointTask task;
    task.z = JointVector::Zero(q.size());
    if (secondary.kind == SecondaryKind::kPosture) {
      task.joints = secondary.joints;
      for (std::size_t k = 0; k < secondary.joints.size(); ++k) {
        const Eigen::Index joint = secondary.joints[k];
        task.z(joint) = gain * (secondary.posture_rad[k] - q(joint));
      }
    } else {
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const ArmJoint& joint = options_.arm.joints[static_cast<std::size_t>(i)];
        const double inside = penetration_rad(joint, q(i), secondary.margin);
        if (inside == 0.0) continue;
        task.joints.push_back(i);
        task.z(i) = -gain * inside;
      }
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

ServoCommand Servo::follow(const ServoInput& input, const JointVector& q_at_image) {
  Eigen::Isometry3d T_base_object =
      locate(*input.T_camera_object, camera_pose(options_.arm, q_at_image));
  if (options_.feed_forward) {
    const auto age = static_cast<double>(options_.delay_cycles);
    T_base_object = observer_.carry(T_base_object, age * options_.cycle_s);
  }
  const Eigen::Isometry3d T_base_camera = camera_pose(options_.arm, input.q);
  const Eigen::Isometry3d T_camera_object = T_base_camera.inverse() * T_base_object;
  if (!goal_) {
    goal_ = choose_symmetric_goal(T_camera_object, options_.T_camera_object, options_.symmetry);
  }
  const TaskError task = task_error(T_camera_object, *goal_, options_.symmetry);
  const CameraJacobian J_camera = camera_jacobian(options_.arm, input.q);
  Eigen::VectorXd wanted = -options_.gain_per_s * task.e;
  if (options_.feed_forward) wanted += task.L * target_twist(T_base_camera, T_base_object);
  JointRates solved = solve_rates(options_.arm,
                                  input.q,
                                  task.L * J_camera,
                                  wanted,
                                  joint_tasks(input.q),
                                  options_.cycle_s,
                                  options_.inverse);
  ServoCommand command;
  command.status = ServoStatus::kRunning;
  command.twist = J_camera * solved.rates;
  command.joint_rates = std::move(solved.rates);
  command.error = task.e;
  command.translation_m = task.translation_m;
  command.rotation_rad = task.rotation_rad;
  command.rank = solved.rank;
  command.smallest_singular = solved.smallest_singular;
  command.damped = solved.damped;
  command.rate_scale = solved.scale;
  command.at_limit = std::move(solved.at_limit);
  last_twist_ = command.twist;
  cycles_unseen_ = 0;
  return command;
}

ServoCommand Servo::coast(const JointVector& q) {
  ++cycles_unseen_;
  ServoCommand command;
  command.joint_rates = JointVector::Zero(q.size());
  if (!last_twist_ || cycles_unseen_ > options_.hold_cycles) return command;
  const CameraJacobian J_camera = camera_jacobian(options_.arm, q);
  JointRates solved =
      solve_rates(options_.arm, q, J_camera, *last_twist_, {}, options_.cycle_s, options_.inverse);
  command.status = ServoStatus::kHolding;
  command.twist = J_camera * solved.rates;
  command.joint_rates = std::move(solved.rates);
  command.rank = solved.rank;
  command.smallest_singular = solved.smallest_singular;
  command.damped = solved.damped;
  command.rate_scale = solved.scale;
  command.at_limit = std::move(solved.at_limit);
  return command;
}

}  // namespace landmarkdb
