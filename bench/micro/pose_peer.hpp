#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/micro/pose_problems.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"

namespace landmarkdb::bench {

// A solver of another library for the pose of n points; three have up to four poses, in no order.
struct PosePeer {
  std::string name;
  // Empty: no answer, or the solver does not take such points.
  FoundPoses (*solve)(const std::vector<PosePoint>& points, const Camera& camera);
};

// Those that take `n` points, `planar` or not; empty where the library is not installed.
std::vector<PosePeer> opencv_pose_peers(std::size_t n, bool planar);
std::vector<PosePeer> opengv_pose_peers(std::size_t n, bool planar);

}  // namespace landmarkdb::bench
