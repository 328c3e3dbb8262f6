#pragma once

#include "engine/geometry/camera.hpp"
#include "engine/servo/arm.hpp"

namespace landmarkdb::testing {

// PUMA 560, standard Denavit-Hartenberg table and limits after Corke & Armstrong-Helouvry (1994);
// `max_rate_rad_s` for every joint. The camera: Rz(15 deg), (0.05, 0, 0.08) in the flange.
Arm puma_560(double max_rate_rad_s);

// A small arm of six turning joints as stood in laboratories of the 1990s: an invented table, with
// an offset shoulder, a long last link and narrower ranges than the PUMA's. The same camera.
Arm small_arm(double max_rate_rad_s);

// (0, 45, -180, 0, 60, 0) deg for the PUMA; a bent pose of the small arm, far from its limits.
JointVector puma_560_pose();
JointVector small_arm_pose();

// What the camera should see: the object 0.6 m in front, its z axis towards the camera.
Eigen::Isometry3d wanted_pose();

// What it sees with: 640 x 480, f 600, k1 -0.25.
Camera arm_camera();

}  // namespace landmarkdb::testing
