#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/geometry/pose.hpp"

namespace landmarkdb::testing {

// The squared error in units of the covariance, a freedom: 1 on the mean where the covariance is
// true (normalised estimation error squared, Bar-Shalom, Li & Kirubarajan 2001, over six).
inline double normalised_squared_error(const Eigen::Matrix<double, 6, 6>& covariance,
                                       const Eigen::Matrix4d& T_scene_sensor,
                                       const Eigen::Isometry3d& truth) {
  const Eigen::AngleAxisd turn(
      nearest_rotation(T_scene_sensor.topLeftCorner<3, 3>() * truth.linear().transpose()));
  Eigen::Matrix<double, 6, 1> error;
  error << T_scene_sensor.topRightCorner<3, 1>() - truth.translation(), turn.angle() * turn.axis();
  return error.dot(covariance.ldlt().solve(error)) / 6.0;
}

}  // namespace landmarkdb::testing
