#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/pose.hpp"
#include "engine/types/correspondence.hpp"

namespace landmarkdb {

struct PoseOptions {
  double max_residual_m = 0.1;  // a correspondence is an inlier below this distance
  std::size_t min_inliers = 4;  // a similarity asks for four pairs (Cocias et al. 2014)
  std::uint32_t max_iterations = 10'000;
  double confidence = 0.999;    // stop when a better sample is this unlikely to exist
  double edge_tolerance = 0.9;  // two pairs agree when their lengths have at least this ratio
  bool estimate_scale = false;
  std::uint64_t seed = 1;  // same seed, same input: same answer, bit for bit
};

struct PoseEstimate {
  Similarity T_target_source;
  std::vector<std::uint32_t> inliers;  // indices into the correspondences, ascending
};

// Finds the motion that carries the source's keypoints onto the target's, among correspondences
// most of which may be wrong: draws three at a time, keeps those whose triangles are alike, fits
// (Umeyama 1991), and refits the motion that most correspondences agree with to all of these.
//
// Positions in metres, each in its own frame; a correspondence's `target` and `query` index them.
// Returns nullopt when fewer than `min_inliers` agree. Throws Error{kInvalidArgument} when a
// correspondence points outside its array. Cost: O(max_iterations * correspondences). Thread-safe.
std::optional<PoseEstimate> estimate_pose(std::span<const Eigen::Vector3f> target,
                                          std::span<const Eigen::Vector3f> source,
                                          std::span<const Correspondence> correspondences,
                                          const PoseOptions& options);

}  // namespace landmarkdb
