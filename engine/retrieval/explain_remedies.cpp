#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "engine/base/print.hpp"
#include "engine/retrieval/expected.hpp"
#include "engine/retrieval/explain.hpp"

namespace landmarkdb {

namespace {

constexpr std::uint32_t kFewestPairs = 4;  // pairs a similarity is estimated from

std::string effect_name(QueryStatus status) {
  return status == QueryStatus::kLocalized ? "localized" : "ambiguous";
}

QueryStatus decide(const Decision& decision,
                   std::vector<Assessed> poses,
                   const VerdictOptions& options) {
  return judge(std::move(poses), decision.input.entries, decision.input.query.centre, options)
      .status;
}

// The verdict if only the poses that pass had been found.
QueryStatus decide_among(const Decision& decision,
                         const std::function<bool(const Assessed&)>& passes) {
  std::vector<Assessed> poses;
  std::copy_if(decision.search.poses.begin(),
               decision.search.poses.end(),
               std::back_inserter(poses),
               passes);
  return decide(decision, std::move(poses), decision.options);
}

const SceneRecord& record_of(const Decision& decision, const Assessed& pose) {
  return decision.input.entries[pose.entry].record();
}

// The highest demand, in hundredths below the one made, at which the answer is no longer "not
// found".
void try_min_confidence(const Decision& decision, std::vector<Remedy>& remedies) {
  if (decision.verdict.status != QueryStatus::kNotFound) return;
  VerdictOptions options = decision.options;
  const int highest = static_cast<int>(std::ceil(100.0 * options.min_confidence)) - 1;
  for (int hundredths = highest; hundredths >= 1; --hundredths) {
    options.min_confidence = hundredths / 100.0;
    const QueryStatus status = decide(decision, decision.search.poses, options);
    if (status == QueryStatus::kNotFound) continue;
    remedies.push_back(
        {"--min-confidence", print("%.2f", options.min_confidence), effect_name(status)});
    return;
  }
}

// Gravity, were it known to be as the best pose has it.
void try_up(const Decision& decision, std::vector<Remedy>& remedies) {
  const Assessed& best = decision.verdict.judged[0].pose;
  const SceneRecord& record = record_of(decision, best);
  if (decision.input.options.up || !record.up) return;
  QueryOptions options = decision.input.options;
  options.up = best.T_entry_sensor.linear().transpose() * *record.up;
  const QueryStatus status = decide_among(decision, [&](const Assessed& pose) {
    return agrees_with_up(pose, record_of(decision, pose), options);
  });
  if (status == QueryStatus::kLocalized) remedies.push_back({"--up", "", effect_name(status)});
}

// Each of the best places' scenes alone.
void try_scene(const Decision& decision, std::vector<Remedy>& remedies) {
  constexpr std::size_t kMostScenes = 3;
  std::vector<std::size_t> tried;
  for (const Judged& judged : decision.verdict.judged) {
    const std::size_t entry = judged.pose.entry;
    if (tried.size() >= kMostScenes) break;
    if (std::find(tried.begin(), tried.end(), entry) != tried.end()) continue;
    tried.push_back(entry);
    const QueryStatus status =
        decide_among(decision, [&](const Assessed& pose) { return pose.entry == entry; });
    if (status != QueryStatus::kLocalized) continue;
    remedies.push_back({"--scene", record_of(decision, judged.pose).name, effect_name(status)});
  }
}

// A prior about the best pose, as wide as it may be: half way to the nearest other place.
void try_prior(const Decision& decision, std::vector<Remedy>& remedies) {
  if (decision.input.options.prior_T_scene_sensor) return;
  const Assessed& best = decision.verdict.judged[0].pose;
  const CleanQuery& query = decision.input.query;
  const Eigen::Vector3d here = sensor_position(best, record_of(decision, best), query);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Judged& other : decision.verdict.judged) {
    if (&other == &decision.verdict.judged[0]) continue;
    nearest_m = std::min(
        nearest_m,
        (sensor_position(other.pose, record_of(decision, other.pose), query) - here).norm());
  }
  constexpr double kLeast_m = 0.1;  // nobody knows better where a sensor is
  if (!std::isfinite(nearest_m) || 0.5 * nearest_m < kLeast_m) return;
  QueryOptions options = decision.input.options;
  options.prior_T_scene_sensor = Eigen::Isometry3d(Eigen::Translation3d(here));
  options.prior_radius_m = std::floor(5.0 * nearest_m) / 10.0;  // decimetres, rounded down
  if (options.prior_radius_m < kLeast_m) return;
  const QueryStatus status = decide_among(decision, [&](const Assessed& pose) {
    return agrees_with_prior(pose, record_of(decision, pose), query, options);
  });
  if (status != QueryStatus::kLocalized) return;
  remedies.push_back(
      {"--prior-radius", print("%.1f", options.prior_radius_m), effect_name(status)});
}

// What the asker said and every good pose contradicts.
void try_without(const Decision& decision, std::vector<Remedy>& remedies) {
  if (decision.dropped.empty()) return;
  const auto without = [&](const char* option, const QueryOptions& left) {
    std::vector<Assessed> poses = decision.search.poses;
    for (const Assessed& pose : decision.dropped) {
      const SceneRecord& record = record_of(decision, pose);
      if (agrees_with_up(pose, record, left) &&
          agrees_with_prior(pose, record, decision.input.query, left)) {
        poses.push_back(pose);
      }
    }
    const QueryStatus status = decide(decision, std::move(poses), decision.options);
    if (status == QueryStatus::kNotFound || status == decision.verdict.status) return;
    remedies.push_back({std::string("without ") + option, "", effect_name(status)});
  };
  QueryOptions left = decision.input.options;
  left.up.reset();
  if (decision.input.options.up) without("--up", left);
  left = decision.input.options;
  left.prior_T_scene_sensor.reset();
  if (decision.input.options.prior_T_scene_sensor) without("--prior", left);
}

// The filter of the paper's search that had to let more through, of the entry with most pairs.
void try_filters(const Decision& decision, std::vector<Remedy>& remedies) {
  if (decision.search.lost_at != "filter") return;
  const auto most = std::max_element(decision.search.matches.begin(),
                                     decision.search.matches.end(),
                                     [](const EntryMatches& a, const EntryMatches& b) {
                                       return std::pair(a.counts.after_ratio, a.counts.putative) <
                                              std::pair(b.counts.after_ratio, b.counts.putative);
                                     });
  if (most == decision.search.matches.end()) return;
  const CorrespondenceCounts& counts = most->counts;
  if (counts.after_ratio < kFewestPairs) {
    if (most->ratio_for_four > decision.input.options.ratio) {
      remedies.push_back(
          {"--ratio", print("%.2f", most->ratio_for_four), "four pairs past the ratio filter"});
    }
  } else if (counts.after_consistency < kFewestPairs) {
    remedies.push_back({"--filters", "ratio", std::to_string(counts.after_ratio) + " pairs left"});
  }
}

void try_voxel(const Decision& decision, std::vector<Remedy>& remedies) {
  if (decision.search.lost_at != "density") return;
  const double voxel_m = decision.search.needs_voxel_m;
  constexpr double kMillimetre = 1e-3;
  remedies.push_back({"landmarkdb-indexer add --voxel",
                      print("%.3f", std::ceil(voxel_m / kMillimetre) * kMillimetre),
                      "the cloud is dense enough for the scene"});
}

}  // namespace

std::vector<Remedy> find_remedies(const Decision& decision) {
  std::vector<Remedy> remedies;
  if (decision.verdict.status == QueryStatus::kLocalized) return remedies;
  try_without(decision, remedies);
  if (!decision.verdict.judged.empty()) {
    try_up(decision, remedies);
    try_scene(decision, remedies);
    try_prior(decision, remedies);
    try_min_confidence(decision, remedies);
  } else {
    try_filters(decision, remedies);
    try_voxel(decision, remedies);
  }
  return remedies;
}

}  // namespace landmarkdb
