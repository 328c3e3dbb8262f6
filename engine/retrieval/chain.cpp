#include "engine/retrieval/chain.hpp"

#include <optional>

#include "engine/geometry/pose.hpp"
#include "engine/registration/propose.hpp"

namespace landmarkdb {

namespace {

std::vector<std::uint32_t> agreeing(const ChainInput& input) {
  std::vector<std::uint32_t> inliers;
  for (std::uint32_t i = 0; i < input.correspondences.size(); ++i) {
    const Correspondence& pair = input.correspondences[i];
    const Eigen::Vector3d there =
        input.T_entry_sensor * input.query.keypoints[pair.query].cast<double>();
    if ((there - input.entry.keypoints[pair.target].cast<double>()).norm() <= input.inlier_m) {
      inliers.push_back(i);
    }
  }
  return inliers;
}

// The pair that proposed the pose; where none did, the one that agrees best with it.
Correspondence proposer_of(const ChainInput& input) {
  if (input.proposer != kNoCorrespondence) return input.correspondences[input.proposer];
  const auto distance = [&](const Correspondence& pair) {
    const Eigen::Vector3d there =
        input.T_entry_sensor * input.query.keypoints[pair.query].cast<double>();
    return (there - input.entry.keypoints[pair.target].cast<double>()).squaredNorm();
  };
  const Correspondence* best = &input.correspondences[0];
  for (const Correspondence& pair : input.correspondences) {
    if (distance(pair) < distance(*best)) best = &pair;
  }
  return *best;
}

Eigen::Isometry3d frame_at(const DescriptorSet& set, std::uint32_t keypoint) {
  Eigen::Isometry3d T_cloud_lrf = Eigen::Isometry3d::Identity();
  T_cloud_lrf.linear() = nearest_rotation(set.frames[keypoint].cast<double>());
  T_cloud_lrf.translation() = set.keypoints[keypoint].cast<double>();
  return T_cloud_lrf;
}

std::optional<Similarity> similarity_of(const ChainInput& input,
                                        const Eigen::Isometry3d& T_landmark_sensor,
                                        std::span<const std::uint32_t> inliers) {
  constexpr std::size_t kFewest = 4;  // pairs a similarity is estimated from (Cocias et al. 2014)
  if (inliers.size() < kFewest) return std::nullopt;
  std::vector<Eigen::Vector3d> scene;
  std::vector<Eigen::Vector3d> landmark;
  for (const std::uint32_t i : inliers) {
    const Correspondence& pair = input.correspondences[i];
    scene.push_back(input.entry.keypoints[pair.target].cast<double>());
    landmark.push_back(T_landmark_sensor * input.query.keypoints[pair.query].cast<double>());
  }
  return estimate_similarity(scene, landmark, input.estimate_scale);
}

}  // namespace

ChainResult make_chain(const ChainInput& input) {
  ChainResult result;
  result.inliers = agreeing(input);
  const Correspondence proposer = proposer_of(input);
  const Eigen::Isometry3d T_landmark_sensor = frame_at(input.query, proposer.query).inverse();
  Similarity T_scene_landmark;
  const Eigen::Isometry3d T_scene_lrf = frame_at(input.entry, proposer.target);
  T_scene_landmark.R = T_scene_lrf.linear();
  T_scene_landmark.t = T_scene_lrf.translation();
  if (const auto fitted = similarity_of(input, T_landmark_sensor, result.inliers))
    T_scene_landmark = *fitted;

  PoseChain& chain = result.chain;
  chain.scale = T_scene_landmark.scale;
  chain.T_landmark_sensor = T_landmark_sensor.matrix();
  chain.T_scene_landmark = T_scene_landmark.matrix();
  // Refinement is rigid, so with an estimated scale the chain keeps that scale and corrects the
  // rest.
  Similarity refined;
  refined.R = input.T_entry_sensor.linear();
  refined.t = input.T_entry_sensor.translation();
  chain.T_icp = refined.matrix() * (chain.T_scene_landmark * chain.T_landmark_sensor).inverse();
  if (chain.scale == 1.0)
    chain.T_icp.topLeftCorner<3, 3>() = nearest_rotation(chain.T_icp.topLeftCorner<3, 3>());
  chain.T_icp.row(3) << 0.0, 0.0, 0.0, 1.0;
  result.T_entry_sensor = chain.T_icp * chain.T_scene_landmark * chain.T_landmark_sensor;
  return result;
}

}  // namespace landmarkdb
