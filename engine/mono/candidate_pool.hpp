#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/mono/pose_check.hpp"

namespace landmarkdb {

// log10 of the number of false alarms below which a hypothesis is beyond doubt: searching ends.
// Where the image's edges are known they have to agree: corners of real things stand in rows and
// rectangles, and fall into place by chance more often than points strewn at random. Wrong ones of
// rendered pictures had -11.5 and more (landmarkdb-bench-mono calibrate): below -16 a part of the
// edges may be hidden.
inline constexpr double kBeyondDoubt = -4.0;
inline constexpr double kBeyondDoubtWithEdges = -12.0;
inline constexpr double kBeyondDoubtShare = 0.85;  // of the visible edges
inline constexpr double kBeyondDoubtHidden = -16.0;
inline constexpr double kBeyondDoubtHiddenShare = 0.75;
bool is_beyond_doubt(double log10_nfa, double edge_share);  // in an image with edges

// The hypotheses of one search that have passed, each model's pose once.
class CandidatePool {
 public:
  CandidatePool(std::span<const SearchModel> models, PoseCheck& check)
      : models_(models), check_(check), settled_(models.size(), 0) {}

  // Looks at a pose and, where it passes and is new, settles and keeps it.
  void try_pose(std::uint32_t model, const RigidPose& pose);

  // What try_pose would go by: see PoseCheck::count_near.
  std::size_t count_near(std::uint32_t model, const RigidPose& pose) {
    return check_.count_near(model, pose);
  }

  // Each model may be settled as often again: for a search of another kind.
  void renew_allowance() { settled_.assign(models_.size(), 0); }

  void add(MonoCandidate candidate);
  bool beyond_doubt() const { return beyond_doubt_; }
  std::vector<MonoCandidate>& candidates() { return candidates_; }

 private:
  bool is_known(std::uint32_t model, const RigidPose& pose) const;

  std::span<const SearchModel> models_;
  PoseCheck& check_;
  std::vector<MonoCandidate> candidates_;
  void judge(const MonoCandidate& candidate);

  bool beyond_doubt_ = false;
  std::vector<std::size_t> settled_;  // by model
};

}  // namespace landmarkdb
