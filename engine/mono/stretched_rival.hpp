#pragma once

#include <span>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// Three axes at right angles along which bodies like this one differ from each other: columns. The
// directions of most of its edges' length where edges meet at right angles, as those of boxes do.
Eigen::Matrix3d stretch_axes(const SearchModel& model);

// A body of other proportions that explains the image best, starting from the model at a pose: its
// extents along stretch_axes, as logarithms of ratios to the model's, their mean zero (size and
// distance cannot be told apart).
struct Stretch {
  Eigen::Vector3d log_ratios = Eigen::Vector3d::Zero();
  double log10_odds = 0.0;  // see stretched_rival
};

// Whether the image shows the model or a body of other proportions: points and edges fix pose and
// two ratios together (Gauss and Newton), and the odds compare how likely such ratios are of a body
// made as its model says, to its tolerance, with those of a body of any proportions. Positive for
// the model; about zero where the view does not tell proportions. 0.1 ms.
Stretch stretched_rival(const SearchModel& model,
                        const Camera& camera,
                        const RigidPose& pose,
                        std::span<const PosePoint> points,
                        std::span<const PoseEdge> edges);

}  // namespace landmarkdb
