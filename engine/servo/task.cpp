#include "engine/servo/task.hpp"

#include <charconv>
#include <cmath>
#include <numbers>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

constexpr double kSmallAngle_rad = 1e-4;  // below, series are exact to 1e-17
constexpr int kLargestOrder = 360;

double sinc(double x) {
  return std::abs(x) < kSmallAngle_rad ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

// L_w of theta-u (Chaumette & Hutchinson 2006), for the twist of the frame that turns:
// I + (theta / 2) [u] + (1 - sinc(theta) / sinc^2(theta / 2)) [u]^2.
Eigen::Matrix3d rotation_interaction(const Eigen::Vector3d& theta_u) {
  const double theta = theta_u.norm();
  const Eigen::Matrix3d W = cross_matrix(theta_u);
  // The last factor over theta^2, which tends to 1/12.
  const double half = sinc(theta / 2.0);
  const double factor =
      theta < kSmallAngle_rad ? 1.0 / 12.0 : (1.0 - sinc(theta) / (half * half)) / (theta * theta);
  return Eigen::Matrix3d::Identity() + 0.5 * W + factor * W * W;
}

TaskError full_error(const Eigen::Isometry3d& T_camera_object,
                     const Eigen::Isometry3d& T_wanted_object) {
  const Eigen::Isometry3d T_wanted_camera = T_wanted_object * T_camera_object.inverse();
  TaskError task;
  task.e.resize(6);
  task.e.head<3>() = T_wanted_camera.translation();
  task.e.tail<3>() = rotation_vector(T_wanted_camera.linear());
  task.L = Eigen::Matrix<double, 6, 6>::Zero();
  task.L.topLeftCorner<3, 3>() = T_wanted_camera.linear();
  task.L.bottomRightCorner<3, 3>() = rotation_interaction(task.e.tail<3>());
  task.translation_m = task.e.head<3>().norm();
  task.rotation_rad = task.e.tail<3>().norm();
  return task;
}

// p - p* and its interaction matrix [-I, [p]x], in the first three rows of `task`.
void set_position_rows(const Eigen::Vector3d& p, const Eigen::Vector3d& p_wanted, TaskError& task) {
  task.e.head<3>() = p - p_wanted;
  task.L.topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  task.L.topRightCorner<3, 3>() = cross_matrix(p);
  task.translation_m = task.e.head<3>().norm();
}

// The turn w that carries direction n* to n by the shortest way, and dw / domega. With s = n* x n,
// c = n* . n and f = theta / sin(theta): w = f s; a turning camera sees n_dot = [n]x omega.
void set_axis_rows(const Eigen::Vector3d& n, const Eigen::Vector3d& n_wanted, TaskError& task) {
  const Eigen::Vector3d s = n_wanted.cross(n);
  const double c = n_wanted.dot(n);
  const double theta = std::atan2(s.norm(), c);
  double f = 1.0 + theta * theta / 6.0;
  double df_dc = -1.0 / 3.0;
  if (theta > kSmallAngle_rad) {
    f = theta / s.norm();
    df_dc = (c * f - 1.0) / s.squaredNorm();
  }
  Eigen::Vector3d w = f * s;
  Eigen::Matrix3d W =
      (f * cross_matrix(n_wanted) + df_dc * s * n_wanted.transpose()) * cross_matrix(n);
  constexpr double kOpposite = 1e-6;  // sin(theta) below which any axis is as good
  if (c < 0.0 && s.norm() < kOpposite) {
    w = std::numbers::pi * n_wanted.unitOrthogonal();
    W = -(Eigen::Matrix3d::Identity() - n_wanted * n_wanted.transpose());
  }
  // B*: two directions orthogonal to n*, the same whatever is seen.
  Eigen::Matrix<double, 2, 3> B;
  B.row(0) = n_wanted.unitOrthogonal().transpose();
  B.row(1) = n_wanted.cross(n_wanted.unitOrthogonal()).transpose();
  task.e.tail<2>() = B * w;
  task.L.bottomLeftCorner<2, 3>().setZero();
  task.L.bottomRightCorner<2, 3>() = B * W;
  task.rotation_rad = w.norm();
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& w) {
  Eigen::Matrix3d W;
  W << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return W;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond turn(R);
  if (turn.w() < 0.0) turn.coeffs() *= -1.0;  // the shorter way
  const double sine = turn.vec().norm();
  const double angle = 2.0 * std::atan2(sine, turn.w());
  return sine < 1e-300 ? Eigen::Vector3d(2.0 * turn.vec())
                       : Eigen::Vector3d(angle / sine * turn.vec());
}

ServoSymmetry parse_servo_symmetry(std::string_view text) {
  if (text == "none") return {};
  if (text == "revolution") return {.kind = ServoSymmetryKind::kRevolution};
  if (text == "sphere") return {.kind = ServoSymmetryKind::kSphere};
  if (text.starts_with('c') && text.size() > 1) {
    int order = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data() + 1, end, order);
    if (error == std::errc() && stopped == end && order >= 2 && order <= kLargestOrder) {
      return {.kind = ServoSymmetryKind::kCyclic, .order = order};
    }
  }
  constexpr std::size_t kShown = 40;
  throw Error(ErrorCode::kInvalidArgument,
              "symmetry is \"" + std::string(text.substr(0, kShown)) +
                  "\", want none, c2 to c360, revolution or sphere");
}

std::string to_string(const ServoSymmetry& symmetry) {
  switch (symmetry.kind) {
    case ServoSymmetryKind::kCyclic:
      return "c" + std::to_string(symmetry.order);
    case ServoSymmetryKind::kRevolution:
      return "revolution";
    case ServoSymmetryKind::kSphere:
      return "sphere";
    case ServoSymmetryKind::kNone:
      break;
  }
  return "none";
}

TaskError task_error(const Eigen::Isometry3d& T_camera_object,
                     const Eigen::Isometry3d& T_wanted_object,
                     const ServoSymmetry& symmetry) {
  if (symmetry.kind == ServoSymmetryKind::kNone || symmetry.kind == ServoSymmetryKind::kCyclic) {
    return full_error(T_camera_object, T_wanted_object);
  }
  const bool axis = symmetry.kind == ServoSymmetryKind::kRevolution;
  TaskError task;
  task.e.resize(axis ? 5 : 3);
  task.L.resize(axis ? 5 : 3, 6);
  set_position_rows(T_camera_object.translation(), T_wanted_object.translation(), task);
  if (axis) set_axis_rows(T_camera_object.linear().col(2), T_wanted_object.linear().col(2), task);
  return task;
}

Eigen::Isometry3d choose_symmetric_goal(const Eigen::Isometry3d& T_camera_object,
                                        const Eigen::Isometry3d& T_wanted_object,
                                        const ServoSymmetry& symmetry) {
  if (symmetry.kind != ServoSymmetryKind::kCyclic) return T_wanted_object;
  Eigen::Isometry3d best = T_wanted_object;
  double best_rad = std::numbers::pi + 1.0;
  constexpr double kTie_rad = 1e-9;
  for (int i = 0; i < symmetry.order; ++i) {
    // 0, 1, -1, 2, -2, ...: the smaller turn first.
    const int step = i % 2 == 0 ? -(i / 2) : (i + 1) / 2;
    const Eigen::AngleAxisd turn(2.0 * std::numbers::pi * step / symmetry.order,
                                 Eigen::Vector3d::UnitZ());
    const Eigen::Isometry3d goal = T_wanted_object * turn;
    const double angle = rotation_angle_rad(goal.linear() * T_camera_object.linear().transpose());
    if (angle < best_rad - kTie_rad) {
      best_rad = angle;
      best = goal;
    }
  }
  return best;
}

}  // namespace landmarkdb
