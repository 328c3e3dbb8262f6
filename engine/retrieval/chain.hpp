#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/types/correspondence.hpp"
#include "engine/types/features.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// What a pose's chain is made from; indices of `correspondences` name `query` and `entry`
// keypoints.
struct ChainInput {
  const DescriptorSet& query;
  const DescriptorSet& entry;
  std::span<const Correspondence> correspondences;
  // The correspondence whose frames proposed the pose; kNoCorrespondence: the one that agrees best.
  std::uint32_t proposer = 0;
  Eigen::Isometry3d T_entry_sensor;  // the refined pose
  double inlier_m = 0.0;             // a correspondence within this distance agrees with it
  bool estimate_scale = false;
};

struct ChainResult {
  PoseChain chain;                     // entry coordinates
  Eigen::Matrix4d T_entry_sensor;      // the chain multiplied out
  std::vector<std::uint32_t> inliers;  // indices into the correspondences
};

// The pose as the paper's chain of three: T_landmark_sensor takes the sensor into the local frame
// of the surface that was recognised (the local reference frame of its query keypoint),
// T_scene_landmark lays that surface into the scene by the similarity of the agreeing
// correspondences, T_icp is what refinement added. With fewer than four agreeing correspondences
// the two local reference frames give T_scene_landmark.
ChainResult make_chain(const ChainInput& input);

}  // namespace landmarkdb
