#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// Which motions of the object cannot be seen, so that the arm need not undo them. All about the
// z axis of the object frame.
enum class ServoSymmetryKind {
  kNone,
  kCyclic,      // a turn of 1/order about z carries the object onto itself
  kRevolution,  // every turn about z does
  kSphere       // every turn about the origin does
};

struct ServoSymmetry {
  ServoSymmetryKind kind = ServoSymmetryKind::kNone;
  int order = 1;  // of kCyclic

  bool operator==(const ServoSymmetry&) const = default;
};

// "none", "c2", "c3", ... "c360", "revolution", "sphere", as models name their symmetry; nothing
// else. Throws Error{kInvalidArgument} that says what was wanted.
ServoSymmetry parse_servo_symmetry(std::string_view text);
std::string to_string(const ServoSymmetry& symmetry);

// A task function e(pose) (Samson, Le Borgne & Espiau 1991) and its interaction matrix:
// e_dot = L (v, omega), with the camera's twist in the camera frame and the object at rest.
struct TaskError {
  Eigen::VectorXd e;                           // m and rad: 6, 5 or 3 numbers
  Eigen::Matrix<double, Eigen::Dynamic, 6> L;  // as many rows
  double translation_m = 0.0;                  // the part of the error that counts, as two numbers
  double rotation_rad = 0.0;                   // for people; 0 for a sphere
};

// How far the camera is from where it sees the object at `T_wanted_object`.
//
//   kNone, kCyclic: t and theta-u of T_wanted_camera (choose_symmetric_goal picks the turn first);
//   kRevolution: p - p* and the turn from n* to n, its two components orthogonal to n*, where p is
//     the object's origin and n its z axis, in the camera frame;
//   kSphere: p - p*.
// L is exact, not its value at the goal. A turn by pi has no unique axis; one is chosen.
TaskError task_error(const Eigen::Isometry3d& T_camera_object,
                     const Eigen::Isometry3d& T_wanted_object,
                     const ServoSymmetry& symmetry);

// Of the poses that look like `T_wanted_object`, the one nearest in rotation to where the camera
// is: kCyclic tries its turns about z, the others return the wanted pose. Ties go to the smaller
// turn. To be called once and kept, or the goal would jump.
Eigen::Isometry3d choose_symmetric_goal(const Eigen::Isometry3d& T_camera_object,
                                        const Eigen::Isometry3d& T_wanted_object,
                                        const ServoSymmetry& symmetry);

// A rotation as axis times angle (radians, angle in [0, pi]).
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& R);

// The matrix [w]x of the cross product.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& w);

}  // namespace landmarkdb
