#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/edge_search.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/track_samples.hpp"

namespace landmarkdb {

struct AlignOptions {
  double reach_px = 20.0;       // a sample is drawn to the nearest candidate within it
  double edge_sigma_px = 0.5;   // of an edge's place, next to a point's own sigma
  double crowded_sigmas = 4.0;  // by how much less an edge says that another runs beside
  int rounds = 8;               // of choosing candidates anew
};

// A pose and what it rests on.
struct Alignment {
  RigidPose pose;
  bool fixed = false;  // false: too little was found to fix all six freedoms; `pose` is the start
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_px = 0.0;              // of what was kept
  std::vector<double> edge_off_px;  // a sample's distance to its candidate; infinite without
};

// Draws a model onto image edges and points from a pose near by: each sample to its nearest
// candidate, chosen anew every round, by Levenberg and Marquardt with Tukey's weights (Drummond &
// Cipolla 2002; several candidates a sample as in Vacchetti, Lepetit & Fua 2004). Points are given
// with their partners; far ones get no weight.
Alignment align_model(std::span<const TrackSample> samples,
                      const EdgeCandidates& candidates,
                      std::span<const PosePoint> points,
                      const Camera& camera,
                      const RigidPose& start,
                      const AlignOptions& options);

}  // namespace landmarkdb
