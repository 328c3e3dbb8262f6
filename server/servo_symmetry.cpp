#include "server/servo_symmetry.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr double kTolerance = 1e-3;  // of the model's size, and of a unit direction

bool on_axis(const Eigen::Vector3d& xyz, const MonoModel& model) {
  return xyz.head<2>().norm() <= kTolerance * model.diameter_m;
}

// The turn leaves the z axis where it is.
bool about_z(const Eigen::Matrix4d& T, const MonoModel& model) {
  const Eigen::Vector3d moved = T.block<3, 1>(0, 2) - Eigen::Vector3d::UnitZ();
  return moved.norm() <= kTolerance &&
         T.topRightCorner<3, 1>().norm() <= kTolerance * model.diameter_m;
}

bool revolves_about_z(const MonoModel& model) {
  return std::all_of(model.circles.begin(), model.circles.end(), [&](const ModelCircle& circle) {
    return on_axis(circle.center, model) &&
           circle.normal.head<2>().norm() <= kTolerance * circle.normal.norm();
  });
}

}  // namespace

ServoSymmetry servo_symmetry_of(const MonoModel& model) {
  const std::string& name = model.symmetry_class;
  if (name == "revolution") {
    return revolves_about_z(model) ? parse_servo_symmetry(name) : ServoSymmetry{};
  }
  const bool cyclic = name.size() > 1 && name[0] == 'c' && name[1] >= '1' && name[1] <= '9';
  if (!cyclic || !std::all_of(model.symmetries.begin(),
                              model.symmetries.end(),
                              [&](const Eigen::Matrix4d& T) { return about_z(T, model); })) {
    return {};
  }
  try {
    return parse_servo_symmetry(name);
  } catch (const Error&) {  // finer than an arm file may name
    return {};
  }
}

}  // namespace landmarkdb
