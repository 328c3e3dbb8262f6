#pragma once

#include <limits>
#include <span>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"

namespace landmarkdb {

struct RefineOptions {
  double huber = std::numeric_limits<double>::infinity();  // sigmas; see add_points
  int max_steps = 20;
};

// A pose on its way to the minimum, between steps.
struct RefineState {
  RigidPose pose;
  PoseEquations equations;  // at `pose`
  double damping = 1e-6;    // relative, on the diagonal
  bool at_rest = false;
};

// False where a point or edge is not seen from the start, which is then no start.
bool start_refinement(std::span<const PosePoint> points,
                      std::span<const PoseEdge> edges,
                      const Camera& camera,
                      const RigidPose& start,
                      const RefineOptions& options,
                      RefineState& state);

// Up to `steps` steps of Levenberg and Marquardt: damping x 0.1 where the cost falls, x 10 where it
// does not or a point gets behind the camera. At rest once the cost falls by less than a billionth,
// the step is below 1e-10, or the damping is above 1e8. Unknowns are a turn of the camera frame and
// the translation, never Euler angles.
void refine_steps(std::span<const PosePoint> points,
                  std::span<const PoseEdge> edges,
                  const Camera& camera,
                  const RefineOptions& options,
                  int steps,
                  RefineState& state);

// The covariance (x, y, z, rx, ry, rz; camera frame, m and rad; the turn is about the object's
// origin) for residuals of one sigma; zero where the points do not fix the pose.
Eigen::Matrix<double, 6, 6> pose_covariance(const PoseEquations& equations);

}  // namespace landmarkdb
