#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb::bench {

// What a pose solver is asked: points of an object 0.2 m across, 0.8 to 1.2 m before the camera.
struct PoseProblem {
  std::vector<PosePoint> points;
  RigidPose truth;
};

struct PoseSet {
  std::size_t points = 10;
  bool planar = false;    // four planar points are a square
  double noise_px = 0.5;  // of each coordinate
};

// 640 x 480, f 600 px.
Camera pose_camera();

// Same arguments, same problems.
std::vector<PoseProblem> draw_problems(const PoseSet& set, std::size_t count, std::uint64_t seed);

// How far poses are off, over a set of problems.
struct PoseErrors {
  double turn_deg = 0.0, turn_p95_deg = 0.0;
  double shift_mm = 0.0, shift_p95_mm = 0.0;
  double wrong = 0.0;         // share over 15 degrees off
  double wrong_unsaid = 0.0;  // of these, those whose other pose is not right either
};

// The poses a solver has found of one problem, the better first; none: it has no answer.
using FoundPoses = std::vector<RigidPose>;

PoseErrors errors_of(const std::vector<PoseProblem>& problems,
                     const std::vector<FoundPoses>& found);

}  // namespace landmarkdb::bench
