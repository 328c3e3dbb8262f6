#include "engine/retrieval/verdict.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "engine/retrieval/confidence.hpp"
#include "engine/retrieval/rank_poses.hpp"

namespace landmarkdb {

namespace {

// Keeps the best of each group of like poses; they come sorted by score.
std::vector<Assessed> distinct(std::vector<Assessed> assessed,
                               std::span<const Entry> entries,
                               const Eigen::Vector3d& centre,
                               const VerdictOptions& options) {
  std::sort(assessed.begin(), assessed.end(), [](const Assessed& a, const Assessed& b) {
    return a.score != b.score ? a.score > b.score : a.entry < b.entry;
  });
  std::vector<Assessed> kept;
  for (Assessed& candidate : assessed) {
    const double cell_m = entries[candidate.entry].grid.cell_m();
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Assessed& other) {
      return other.entry == candidate.entry &&
             same_pose(candidate.T_entry_sensor,
                       other.T_entry_sensor,
                       centre,
                       options.different_translation_cells * cell_m,
                       options.different_rotation_rad);
    });
    if (!known) kept.push_back(std::move(candidate));
  }
  return kept;
}

std::string why_not(const Judged& best) {
  char text[200];
  std::snprintf(
      text,
      sizeof text,
      "verify: the best pose explains %.0f %% of the cloud, %.0f %% of what it should see is "
      "contradicted, confidence %.2f",
      100.0 * best.pose.evidence.overlap,
      100.0 * best.pose.evidence.crossed,
      best.confidence);
  return text;
}

}  // namespace

Verdict judge(std::vector<Assessed> assessed,
              std::span<const Entry> entries,
              const Eigen::Vector3d& centre,
              const VerdictOptions& options) {
  Verdict verdict;
  const std::vector<Assessed> poses = distinct(std::move(assessed), entries, centre, options);
  if (poses.empty() || !(poses[0].score > 0.0)) {
    verdict.reason = "pose: no proposal lies on the surface of any entry";
    return verdict;
  }
  const double rival_score = poses.size() > 1 ? poses[1].score : 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double best_other = i == 0 ? rival_score : poses[0].score;
    Judged judged{.pose = poses[i], .confidence = 0.0, .margin = 0.0};
    if (poses[i].score > 0.0) judged.margin = std::max(0.0, 1.0 - best_other / poses[i].score);
    judged.confidence = confidence_of(poses[i].evidence, poses[i].score, judged.margin);
    verdict.judged.push_back(std::move(judged));
  }
  const bool rivalled = rival_score >= options.rival_share * poses[0].score;
  // What the best pose would be believed at, were it alone: rivals make it ambiguous, not wrong.
  const double alone = confidence_of(poses[0].evidence, poses[0].score, 1.0);
  if (!rivalled && verdict.judged[0].confidence >= options.min_confidence) {
    verdict.status = QueryStatus::kLocalized;
  } else if (rivalled && alone >= options.min_confidence) {
    verdict.status = QueryStatus::kAmbiguous;
  } else {
    verdict.status = QueryStatus::kNotFound;
    verdict.reason = why_not(verdict.judged[0]);
  }
  return verdict;
}

}  // namespace landmarkdb
