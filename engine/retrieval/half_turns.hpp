#pragma once

#include <array>
#include <span>

#include <Eigen/Geometry>

namespace landmarkdb {

// The half-turns about the three principal axes of a surface, through the middle of its extent
// along them. Much of what is made looks alike turned so, and the turned pose is the rival to be
// told from the pose, or the right one. `points` are not empty.
std::array<Eigen::Isometry3d, 3> half_turns(std::span<const Eigen::Vector3f> points);

}  // namespace landmarkdb
