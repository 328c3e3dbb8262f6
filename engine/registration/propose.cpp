#include "engine/registration/propose.hpp"

namespace landmarkdb {

std::optional<Eigen::Matrix3f> made_upright(const Eigen::Matrix3f& R_target_source,
                                            const Gravity& gravity) {
  const Eigen::Vector3f up = R_target_source * gravity.up_source;
  if (up.dot(gravity.up_target) < gravity.min_cosine) return std::nullopt;
  return Eigen::Quaternionf::FromTwoVectors(up, gravity.up_target).toRotationMatrix() *
         R_target_source;
}

bool is_within(const PositionPrior& prior, const Proposal& proposal) {
  const Eigen::Vector3f sensor =
      proposal.R_target_source * prior.sensor_source + proposal.t_target_source;
  return (sensor - prior.centre).norm() <= prior.radius_m;
}

std::vector<Proposal> propose_from_frames(std::span<const Correspondence> correspondences,
                                          const DescriptorSet& target,
                                          const DescriptorSet& source,
                                          const std::optional<Gravity>& gravity,
                                          const std::optional<PositionPrior>& prior) {
  std::vector<Proposal> proposals;
  proposals.reserve(correspondences.size());
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    const Correspondence& pair = correspondences[i];
    Proposal proposal;
    proposal.correspondence = static_cast<std::uint32_t>(i);
    proposal.R_target_source = target.frames[pair.target] * source.frames[pair.query].transpose();
    if (gravity) {
      const auto upright = made_upright(proposal.R_target_source, *gravity);
      if (!upright) continue;
      proposal.R_target_source = *upright;
    }
    proposal.t_target_source =
        target.keypoints[pair.target] - proposal.R_target_source * source.keypoints[pair.query];
    if (prior && !is_within(*prior, proposal)) continue;
    proposals.push_back(proposal);
  }
  return proposals;
}

}  // namespace landmarkdb
