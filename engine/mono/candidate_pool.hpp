#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/mono/pose_check.hpp"

namespace landmarkdb {

// log10 of the number of false alarms below which a hypothesis is beyond doubt: searching ends.
inline constexpr double kBeyondDoubt = -4.0;

// The hypotheses of one search that have passed, each model's pose once.
class CandidatePool {
 public:
  CandidatePool(std::span<const SearchModel> models, PoseCheck& check)
      : models_(models), check_(check) {}

  // Looks at a pose and, where it passes and is new, settles and keeps it.
  void try_pose(std::uint32_t model, const RigidPose& pose);

  void add(MonoCandidate candidate);
  bool beyond_doubt() const { return best_ < kBeyondDoubt; }
  std::size_t settled() const { return settled_; }
  std::vector<MonoCandidate>& candidates() { return candidates_; }

 private:
  bool is_known(std::uint32_t model, const RigidPose& pose) const;

  std::span<const SearchModel> models_;
  PoseCheck& check_;
  std::vector<MonoCandidate> candidates_;
  double best_ = 1e9;
  std::size_t settled_ = 0;
};

}  // namespace landmarkdb
