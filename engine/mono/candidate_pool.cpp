#include "engine/mono/candidate_pool.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace landmarkdb {
namespace {

// Refinements a search, some 10 us each, shared among the models: one that looks like everything
// must not leave nothing for the others.
constexpr std::size_t kMostSettled = 1000;
constexpr std::size_t kLeastSettled = 20;
// Two poses of a model are one hypothesis where they are nearer than this.
constexpr double kSameAngle_rad = 0.17;  // 10 degrees
constexpr double kSameDistance = 0.05;   // of the depth

}  // namespace

bool is_beyond_doubt(double log10_nfa, double edge_share) {
  return (log10_nfa < kBeyondDoubtWithEdges && edge_share > kBeyondDoubtShare) ||
         (log10_nfa < kBeyondDoubtHidden && edge_share > kBeyondDoubtHiddenShare);
}

bool CandidatePool::is_known(std::uint32_t model, const RigidPose& pose) const {
  for (const MonoCandidate& known : candidates_) {
    // One that holds only with things unlike their models may be on its way to a better one.
    if (known.model == model && !known.unlike &&
        same_but_for_symmetry(models_[model],
                              known.pose,
                              pose,
                              kSameAngle_rad,
                              kSameDistance * known.pose.t.norm())) {
      return true;
    }
  }
  return false;
}

void CandidatePool::judge(const MonoCandidate& candidate) {
  const bool sure = check_.has_edges() ? is_beyond_doubt(candidate.rank(), candidate.edge_share)
                                       : candidate.log10_nfa < kBeyondDoubt;
  beyond_doubt_ = beyond_doubt_ || sure;
}

void CandidatePool::try_pose(std::uint32_t model, const RigidPose& pose) {
  if (settled_[model] >= std::max(kLeastSettled, kMostSettled / models_.size())) return;
  RigidPose grown = pose;
  std::span<const Match> matches = check_.look(model, pose);
  if (matches.empty()) matches = check_.grow(model, grown);
  if (matches.empty() || is_known(model, grown)) return;
  const std::vector<Match> start(matches.begin(), matches.end());
  ++settled_[model];
  std::optional<MonoCandidate> candidate = check_.settle(model, grown, start);
  if (candidate) add(std::move(*candidate));
}

void CandidatePool::add(MonoCandidate candidate) {
  for (MonoCandidate& known : candidates_) {
    if (known.model != candidate.model ||
        !same_but_for_symmetry(models_[known.model],
                               known.pose,
                               candidate.pose,
                               kSameAngle_rad,
                               kSameDistance * known.pose.t.norm())) {
      continue;
    }
    judge(candidate);
    if (candidate.rank() < known.rank()) known = std::move(candidate);
    return;
  }
  judge(candidate);
  candidates_.push_back(std::move(candidate));
}

}  // namespace landmarkdb
