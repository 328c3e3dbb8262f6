#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb::bench {

// A solver of another library for the pose of n points. Not thread-safe.
struct PosePeer {
  std::string name;
  // False: no answer, or the solver does not take such points.
  bool (*solve)(const std::vector<PosePoint>& points, const Camera& camera, RigidPose& pose);
};

// Those that are installed and take `n` points, `planar` or not; empty without
// libopencv-calib3d-dev.
std::vector<PosePeer> pose_peers(std::size_t n, bool planar);

}  // namespace landmarkdb::bench
