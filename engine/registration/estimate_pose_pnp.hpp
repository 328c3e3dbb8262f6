#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "engine/registration/estimate_pose.hpp"
#include "engine/types/correspondence.hpp"

namespace landmarkdb {

// estimate_pose by directions alone: where the source's keypoints are seen from `viewpoint` (source
// frame) against the target's positions. What the source's ranges are does not enter, so it holds
// for keypoints whose range is poor, and gives less where the ranges are good.
//
// Draws three correspondences at a time, keeps the pose that most agree with, and refines it by
// Gauss-Newton on all of these. A correspondence agrees when the target point, at its own range,
// lies within `options.max_residual_m` of the line of sight, in front of the eye.
// `options.estimate_scale` is not used: directions say nothing of scale. Otherwise as
// estimate_pose.
std::optional<PoseEstimate> estimate_pose_pnp(std::span<const Eigen::Vector3f> target,
                                              std::span<const Eigen::Vector3f> source,
                                              const Eigen::Vector3d& viewpoint,
                                              std::span<const Correspondence> correspondences,
                                              const PoseOptions& options);

}  // namespace landmarkdb
