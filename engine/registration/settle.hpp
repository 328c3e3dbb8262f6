#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "engine/registration/pose_score.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

struct SettleOptions {
  std::size_t points = 64;  // of the test points, rounded up to whole groups of 16
  int iterations = 3;
  float sigma_cells = 1.0F;  // as in ScoreOptions
};

// A few cheap steps of point-to-plane ICP with the test points: takes a pose that one local
// reference frame proposed (off by a few decimetres and degrees) to where its score means
// something. A freedom the surface does not fix stays as it was. Float throughout: what comes out
// is to be tested and refined. Deterministic; thread-safe.
void settle_pose(const SurfaceGrid& target,
                 const TestPoints& test,
                 const SettleOptions& options,
                 Eigen::Matrix3f& R_target_source,
                 Eigen::Vector3f& t_target_source);

}  // namespace landmarkdb
