#pragma once

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "engine/geometry/pose.hpp"

namespace landmarkdb::testing {

// Matches a pose within `metres` and `radians` of T; says how far apart the two are when it fails.
MATCHER_P3(PoseNear, T, metres, radians, "") {
  const Eigen::Matrix4d difference = Eigen::Isometry3d(T).matrix().inverse() * arg.matrix();
  const double apart_m =
      (Eigen::Isometry3d(T).matrix() - arg.matrix()).template topRightCorner<3, 1>().norm();
  const double apart_rad = rotation_angle_rad(difference.topLeftCorner<3, 3>());
  *result_listener << apart_m << " m and " << apart_rad << " rad apart";
  return apart_m <= metres && apart_rad <= radians;
}

}  // namespace landmarkdb::testing
