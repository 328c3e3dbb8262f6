#include "engine/retrieval/verdict.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "engine/retrieval/confidence.hpp"

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
    const Entry& entry = entries[candidate.entry];
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Assessed& other) {
      return same_spot(candidate,
                       other,
                       entry,
                       centre,
                       place_radius_m(entry, options),
                       options.different_rotation_rad);
    });
    if (!known) kept.push_back(std::move(candidate));
  }
  return kept;
}

// Only one of two rivals can be right: two places, or two objects at one spot. An object stands in
// a place, and several objects may stand in view.
bool rivals(const Assessed& a, const Assessed& b, std::span<const Entry> entries) {
  const Entry& entry_a = entries[a.entry];
  const Entry& entry_b = entries[b.entry];
  if (entry_a.is_object() != entry_b.is_object()) return false;
  if (!entry_a.is_object()) return true;
  const Eigen::Vector3d spot_a = a.T_entry_sensor.inverse() * entry_a.centre;
  const Eigen::Vector3d spot_b = b.T_entry_sensor.inverse() * entry_b.centre;
  return (spot_a - spot_b).norm() < 0.5 * std::max(entry_a.extent_m, entry_b.extent_m);
}

// The best score among the rivals of poses[i]. Where none was found the search may have missed it:
// one that does well, but not as well, is taken for granted.
double best_rival(std::size_t i, std::span<const Assessed> poses, std::span<const Entry> entries) {
  constexpr double kUnseenRival = 0.6;  // of the pose's own score
  double best = kUnseenRival * poses[i].score;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (j != i && rivals(poses[i], poses[j], entries)) best = std::max(best, poses[j].score);
  }
  return best;
}

// The least contrast to any rival. Where the two were not compared point by point, the scores say
// it: a lead of kFullLead is full contrast.
double least_contrast(std::size_t i,
                      std::span<const Assessed> poses,
                      std::span<const Entry> entries) {
  constexpr double kFullLead = 0.4;
  double least = 1.0;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (j == i || !rivals(poses[i], poses[j], entries)) continue;
    const bool compared = poses[j].id < poses[i].contrast.size();
    const double lead = poses[i].score > 0.0 ? 1.0 - poses[j].score / poses[i].score : 0.0;
    least = std::min(least,
                     compared ? static_cast<double>(poses[i].contrast[poses[j].id])
                              : std::clamp(lead / kFullLead, -1.0, 1.0));
  }
  return least;
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

double place_radius_m(const Entry& entry, const VerdictOptions& options) {
  const double cell_m = entry.grid.cell_m();
  constexpr double kLeastCells = 2.0;
  return std::max(
      kLeastCells * cell_m,
      std::min(options.different_translation_cells * cell_m, options.different_translation_most_m));
}

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
  double rival_score = 0.0;  // of the best pose
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Judged judged{.pose = poses[i], .confidence = 0.0, .margin = 0.0};
    const double rival = best_rival(i, poses, entries);
    if (i == 0) rival_score = rival;
    judged.pose.evidence.contrast = least_contrast(i, poses, entries);
    if (poses[i].score > 0.0) judged.margin = std::max(0.0, 1.0 - rival / poses[i].score);
    judged.confidence = confidence_of(judged.pose.evidence, poses[i].score, judged.margin);
    verdict.judged.push_back(std::move(judged));
  }
  const Evidence& evidence = verdict.judged[0].pose.evidence;
  const bool in_reach = rival_score >= options.reach_share * poses[0].score;
  const double least_contrast = in_reach ? options.least_contrast_in_reach : options.least_contrast;
  const bool sure = verdict.judged[0].confidence >= options.sure_confidence;
  const bool slides = !evidence.of_object && evidence.observability < options.least_observability;
  const bool close =
      rival_score >= options.rival_share * poses[0].score || evidence.contrast < least_contrast;
  const bool rivalled = slides || (!sure && close);
  const double alone = confidence_alone(poses[0].evidence, poses[0].score);
  if (!rivalled && (sure || alone >= options.least_alone) &&
      verdict.judged[0].confidence >= options.min_confidence) {
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
