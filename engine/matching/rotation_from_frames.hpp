#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/types/correspondence.hpp"

namespace landmarkdb {

struct RotationVoteOptions {
  // Two pairs agree when their rotations differ by less: local reference frames of the same surface
  // are some 10 degrees apart, and a ball of 15 degrees holds a thousandth of all rotations.
  double agreement_rad = 0.262;
  std::size_t min_support = 2;
};

struct RotationVote {
  Eigen::Matrix3d R_target_query = Eigen::Matrix3d::Identity();
  std::size_t support = 0;  // pairs that agree with it
};

// The rotations that the pairs' local reference frames agree on, at most `most`, best supported
// first. Each pair proposes R = F_target F_query^T; the proposal that most others agree with (the
// first of equals) is refined to the mean of those, again and again until it stays; then the next
// one that does not agree with a rotation found. Buildings repeat at quarter and half turns, so the
// right rotation is often the second or the fifth.
//
// `target_frames` and `query_frames` are R_cloud_lrf, by the correspondences' indices. Only
// rotations that `min_support` pairs agree with. Up to 2,000 pairs, evenly picked, stand as
// candidates, all vote: cost is linear beyond that. Deterministic, thread-safe. Throws
// Error{kInvalidArgument} when a correspondence points outside its array.
std::vector<RotationVote> rotations_from_frames(std::span<const Correspondence> correspondences,
                                                std::span<const Eigen::Matrix3f> target_frames,
                                                std::span<const Eigen::Matrix3f> query_frames,
                                                std::size_t most,
                                                const RotationVoteOptions& options);

// The best supported of them; nothing when fewer than `min_support` agree.
std::optional<RotationVote> rotation_from_frames(std::span<const Correspondence> correspondences,
                                                 std::span<const Eigen::Matrix3f> target_frames,
                                                 std::span<const Eigen::Matrix3f> query_frames,
                                                 const RotationVoteOptions& options);

}  // namespace landmarkdb
