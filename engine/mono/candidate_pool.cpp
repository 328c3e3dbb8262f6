#include "engine/mono/candidate_pool.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace landmarkdb {
namespace {

constexpr std::size_t kMostSettled = 600;  // refinements a search: some 10 us each
// Two poses of a model are one hypothesis where they are nearer than this.
constexpr double kSameAngle_rad = 0.17;  // 10 degrees
constexpr double kSameDistance = 0.05;   // of the depth

}  // namespace

bool CandidatePool::is_known(std::uint32_t model, const RigidPose& pose) const {
  for (const MonoCandidate& known : candidates_) {
    if (known.model == model && same_but_for_symmetry(models_[model],
                                                      known.pose,
                                                      pose,
                                                      kSameAngle_rad,
                                                      kSameDistance * known.pose.t.norm())) {
      return true;
    }
  }
  return false;
}

void CandidatePool::try_pose(std::uint32_t model, const RigidPose& pose) {
  const std::span<const Match> matches = check_.look(model, pose);
  if (matches.empty() || settled_ >= kMostSettled || is_known(model, pose)) return;
  const std::vector<Match> start(matches.begin(), matches.end());
  ++settled_;
  std::optional<MonoCandidate> candidate = check_.settle(model, pose, start);
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
    if (candidate.log10_nfa < known.log10_nfa) known = std::move(candidate);
    best_ = std::min(best_, known.log10_nfa);
    return;
  }
  best_ = std::min(best_, candidate.log10_nfa);
  candidates_.push_back(std::move(candidate));
}

}  // namespace landmarkdb
