#include "engine/retrieval/verdict.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/print.hpp"
#include "engine/retrieval/confidence.hpp"

namespace landmarkdb {

namespace {

bool better(const Assessed& a, const Assessed& b) {
  return a.score != b.score ? a.score > b.score : a.entry < b.entry;
}

// Of two poses of one spot that score about alike the closer one is right: the score's tolerance
// does not tell a few centimetres along a wall.
bool is_closer(const Assessed& candidate, const Assessed& other) {
  constexpr double kAlike = 0.9;
  return candidate.score >= kAlike * other.score && candidate.closeness > other.closeness;
}

// Keeps one of each group of like poses, sorted by score.
std::vector<Assessed> distinct(std::vector<Assessed> assessed,
                               const Entries& entries,
                               const Eigen::Vector3d& centre,
                               const VerdictOptions& options) {
  std::stable_sort(assessed.begin(), assessed.end(), better);
  std::vector<Assessed> kept;
  for (Assessed& candidate : assessed) {
    const Entry& entry = entries[candidate.entry];
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const Assessed& other) {
      return same_spot(candidate,
                       other,
                       entry,
                       centre,
                       place_radius_m(entry, options),
                       options.different_rotation_rad);
    });
    if (known == kept.end()) {
      kept.push_back(std::move(candidate));
    } else if (is_closer(candidate, *known)) {
      *known = std::move(candidate);
    }
  }
  std::stable_sort(kept.begin(), kept.end(), better);
  return kept;
}

// Only one of two rivals can be right: two places, or two objects at one spot. An object stands in
// a place, and several objects may stand in view.
bool rivals(const Assessed& a, const Assessed& b, const Entries& entries) {
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
double best_rival(std::size_t i, std::span<const Assessed> poses, const Entries& entries) {
  constexpr double kUnseenRival = 0.6;  // of the pose's own score
  double best = kUnseenRival * poses[i].score;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (j != i && rivals(poses[i], poses[j], entries)) best = std::max(best, poses[j].score);
  }
  return best;
}

// Where two poses were not compared point by point, the scores say it: a lead of kFullLead is full
// contrast.
double contrast_to(const Assessed& pose, const Assessed& other) {
  constexpr double kFullLead = 0.4;
  if (other.id < pose.contrast.size()) return static_cast<double>(pose.contrast[other.id]);
  const double lead = pose.score > 0.0 ? 1.0 - other.score / pose.score : 0.0;
  return std::clamp(lead / kFullLead, -1.0, 1.0);
}

// The least contrast to any rival.
double least_contrast(std::size_t i, std::span<const Assessed> poses, const Entries& entries) {
  double least = 1.0;
  for (std::size_t j = 0; j < poses.size(); ++j) {
    if (j == i || !rivals(poses[i], poses[j], entries)) continue;
    least = std::min(least, contrast_to(poses[i], poses[j]));
  }
  return least;
}

// A pose among others, of which the best rival has `rival_score`.
struct Standing {
  Judged judged;
  double rival_score = 0.0;
};

Standing judge_among(std::size_t i, std::span<const Assessed> poses, const Entries& entries) {
  Standing standing{.judged = {.pose = poses[i], .confidence = 0.0, .margin = 0.0},
                    .rival_score = best_rival(i, poses, entries)};
  Judged& judged = standing.judged;
  judged.pose.evidence.contrast = least_contrast(i, poses, entries);
  if (poses[i].score > 0.0) {
    judged.margin = std::max(0.0, 1.0 - standing.rival_score / poses[i].score);
  }
  judged.confidence = confidence_of(judged.pose.evidence, poses[i].score, judged.margin);
  return standing;
}

bool is_sure(const Standing& best, const VerdictOptions& options) {
  return best.judged.confidence >= options.sure_confidence;
}

// To two digits, or as many as tell it from what is wanted.
std::string told_from(double value, double wanted) {
  std::string text = print("%.2f", value);
  for (int digits = 3; digits < 7 && text == print("%.*f", digits - 1, wanted); ++digits) {
    text = print("%.*f", digits, value);
  }
  return text;
}

// What of the following is asked of a pose and not reached; empty where all of it is.
using Lack = std::string;

// The pose cannot be told from itself slid along a wall, or, a bottle's, turned about its axis.
Lack open_freedom(const Evidence& evidence, const VerdictOptions& options) {
  const double least =
      evidence.of_object ? options.least_observability : options.least_observability_of_place;
  if (evidence.observability >= least) return {};
  return print(
      "leaves a freedom open: observability %.4f, wanted %g", evidence.observability, least);
}

// The pose cannot be told from another that reaches this share of its score, with this contrast
// between the two.
Lack close_rival(const Standing& best,
                 double share,
                 double contrast,
                 const VerdictOptions& options) {
  if (share >= options.rival_share) {
    return print("has a rival of %.1f %% of its quality, wanted less than %.0f %%",
                 100.0 * share,
                 100.0 * options.rival_share);
  }
  if (!best.judged.pose.evidence.of_object || is_sure(best, options)) return {};
  const double least =
      share >= options.reach_share ? options.least_contrast_in_reach : options.least_contrast;
  if (contrast >= least) return {};
  return print(
      "has a contrast of %s to its rival, wanted %.2f", told_from(contrast, least).c_str(), least);
}

Lack close_rival(const Standing& best, const VerdictOptions& options) {
  const Assessed& pose = best.judged.pose;
  return close_rival(best, best.rival_score / pose.score, pose.evidence.contrast, options);
}

bool is_rivalled(const Standing& best, const VerdictOptions& options) {
  return !open_freedom(best.judged.pose.evidence, options).empty() ||
         !close_rival(best, options).empty();
}

Lack confidence_lack(double confidence, double least, const char* of) {
  if (confidence >= least) return {};
  return print("has confidence %s, wanted %.2f%s", told_from(confidence, least).c_str(), least, of);
}

// Of an object's pose.
Lack object_lack(const Standing& best, const VerdictOptions& options) {
  const Assessed& pose = best.judged.pose;
  const Evidence& evidence = pose.evidence;
  Lack unsure =
      confidence_lack(best.judged.confidence, options.least_confidence_of_object, " of an object");
  if (!unsure.empty()) return unsure;
  if (!(pose.score >= options.least_score_of_object)) {
    return print("has quality %s, wanted %.2f of an object",
                 told_from(pose.score, options.least_score_of_object).c_str(),
                 options.least_score_of_object);
  }
  if (!(evidence.continued <= options.most_continued)) {
    return print(
        "is of an object whose surface goes on beyond %.0f %% of its outline, wanted at most %.0f "
        "%%",
        100.0 * evidence.continued,
        100.0 * options.most_continued);
  }
  if (!(evidence.contradicted <= options.most_contradicted_of_object)) {
    return print("has %.0f %% of the object's surface contradicted, wanted at most %.0f %%",
                 100.0 * evidence.contradicted,
                 100.0 * options.most_contradicted_of_object);
  }
  if (is_sure(best, options) || confidence_alone(evidence, pose.score) >= options.least_alone)
    return {};
  return "is not believable by its own evidence, however far the others are behind";
}

// All that is asked, in the order in which it is told.
Lack lack_of(const Standing& best, const VerdictOptions& options) {
  const Evidence& evidence = best.judged.pose.evidence;
  Lack lack = confidence_lack(best.judged.confidence, options.min_confidence, "");
  if (lack.empty()) lack = open_freedom(evidence, options);
  if (lack.empty()) lack = close_rival(best, options);
  if (lack.empty() && evidence.of_object) lack = object_lack(best, options);
  return lack;
}

// Whether neither sensor nor scanner looked through much of what a place's pose puts somewhere.
bool leaves_free_space(const Evidence& evidence, const VerdictOptions& options) {
  return evidence.contradicted <= options.most_contradicted &&
         evidence.refuted <= options.most_refuted;
}

bool is_taken(const Standing& best, const VerdictOptions& options) {
  return lack_of(best, options).empty();
}

// Whether the best pose cannot be told from this one.
bool is_rival(const Standing& best,
              const Assessed& other,
              const Entries& entries,
              const VerdictOptions& options) {
  const Assessed& pose = best.judged.pose;
  return rivals(pose, other, entries) &&
         !close_rival(best, other.score / pose.score, contrast_to(pose, other), options).empty();
}

// Whether the pose's own evidence would do, were there no rivals.
bool is_credible_alone(const Assessed& pose, const VerdictOptions& options) {
  const Evidence& evidence = pose.evidence;
  if (confidence_alone(evidence, pose.score) < options.min_confidence) return false;
  return evidence.of_object || leaves_free_space(evidence, options);
}

// The best of the poses, and those that do not come close to it.
std::vector<Assessed> without_close(std::span<const Assessed> poses,
                                    const Entries& entries,
                                    const VerdictOptions& options) {
  std::vector<Assessed> kept{poses[0]};
  for (std::size_t j = 1; j < poses.size(); ++j) {
    const bool close = rivals(poses[0], poses[j], entries) &&
                       poses[j].score >= options.close_share * poses[0].score;
    if (!close) kept.push_back(poses[j]);
  }
  return kept;
}

// Objects that stand apart do not compete, and a wrong pose of one may score above a right one of
// another: what one can be surest of comes first. Poses of places stay as they are.
void put_surest_object_first(std::vector<Assessed>& poses, const Entries& entries) {
  const auto of_object = [&](const Assessed& pose) { return entries[pose.entry].is_object(); };
  if (!std::all_of(poses.begin(), poses.end(), of_object)) return;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    order.emplace_back(-judge_among(i, poses, entries).judged.confidence, i);
  }
  std::sort(order.begin(), order.end());
  std::vector<Assessed> sorted;
  sorted.reserve(order.size());
  for (const auto& [confidence, i] : order) sorted.push_back(std::move(poses[i]));
  poses = std::move(sorted);
}

std::string why_not(const Verdict& verdict) {
  const Evidence& evidence = verdict.judged[0].pose.evidence;
  return "verify: the best pose " + verdict.lacks +
         print(
             "; it explains %.0f %% of the cloud, and %.0f %% of what it should see is "
             "contradicted",
             100.0 * evidence.overlap,
             100.0 * evidence.crossed);
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
              const Entries& entries,
              const Eigen::Vector3d& centre,
              const VerdictOptions& options) {
  Verdict verdict;
  std::vector<Assessed> poses = distinct(std::move(assessed), entries, centre, options);
  if (poses.empty() || !(poses[0].score > 0.0)) {
    verdict.reason = "pose: no proposal lies on the surface of any entry";
    return verdict;
  }
  put_surest_object_first(poses, entries);
  const Standing best = judge_among(0, poses, entries);
  verdict.judged.push_back(best.judged);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    verdict.judged.push_back(judge_among(i, poses, entries).judged);
    verdict.judged.back().rival = is_rival(best, poses[i], entries, options);
  }
  // All that explain the query about equally well come first.
  std::stable_partition(verdict.judged.begin() + 1, verdict.judged.end(), [](const Judged& judged) {
    return judged.rival;
  });
  verdict.lacks = lack_of(best, options);
  if (verdict.lacks.empty()) {
    verdict.status = QueryStatus::kLocalized;
  } else if (is_rivalled(best, options) &&
             (is_credible_alone(poses[0], options) ||
              is_taken(judge_among(0, without_close(poses, entries, options), entries), options))) {
    verdict.status = QueryStatus::kAmbiguous;
  } else {
    verdict.status = QueryStatus::kNotFound;
    verdict.reason = why_not(verdict);
  }
  return verdict;
}

}  // namespace landmarkdb
