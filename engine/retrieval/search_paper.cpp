#include <algorithm>
#include <optional>
#include <utility>

#include "engine/matching/descriptor_index.hpp"
#include "engine/matching/filters.hpp"
#include "engine/matching/rotation_from_frames.hpp"
#include "engine/registration/consistency.hpp"
#include "engine/registration/estimate_pose.hpp"
#include "engine/registration/estimate_pose_pnp.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb {

namespace {

// The nearest, and as many as stand within half a descriptor's support of it, one of which the
// ratio filter must get past: on a surface pi (6 / 3)^2, keypoints being three voxels apart and the
// support twelve.
constexpr std::size_t kNeighbours = 20;
constexpr double kRivalApartSupports = 0.5;

// Rotations that the local reference frames propose, and motions that the pairs left under each
// may hold. Of 12 frames of temple and lobby the right rotation had the most votes in four; its
// look-alikes at quarter and half turns had more in the others.
constexpr std::size_t kRotations = 8;
constexpr int kMotionsEach = 3;
constexpr int kMotionsUnturned = 12;

// A keypoint is one in three voxels, and a pose from few pairs is off by more than one.
constexpr double kResidualCells = 4.0;

bool uses(const QueryOptions& options, Filter filter) {
  // The paper's own: ratio, then slope.
  if (options.filters.empty()) return filter != Filter::kClique;
  return std::find(options.filters.begin(), options.filters.end(), filter) != options.filters.end();
}

// Marks the pairs of `before` that are not in `after`, both in the order of `matches.putative`.
void mark_dropped(EntryMatches& matches,
                  std::span<const Correspondence> after,
                  const char* filter) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < matches.putative.size(); ++i) {
    if (*matches.dropped_by[i] != '\0') continue;
    const Correspondence& pair = matches.putative[i];
    const bool kept =
        next < after.size() && after[next].query == pair.query && after[next].target == pair.target;
    if (kept) {
      ++next;
    } else {
      matches.dropped_by[i] = filter;
    }
  }
}

// Pairs that may all be of one motion.
using Group = std::vector<Correspondence>;

// The rotations under which the slope filter is to look: the one expected where a prior gives it,
// then those that the pairs' frames agree on, without those that contradict gravity.
std::vector<Eigen::Matrix3d> rotations_of(const SearchInput& input,
                                          const EntryMatches& matches,
                                          const std::vector<Correspondence>& pairs) {
  const SceneRecord& record = input.entries[matches.entry].record();
  std::vector<Eigen::Matrix3d> rotations;
  if (input.options.prior_T_scene_sensor) {
    rotations.push_back(input.options.prior_T_scene_sensor->linear());
  }
  const std::optional<Gravity> gravity = gravity_of(input.options, record);
  for (const RotationVote& vote : rotations_from_frames(
           pairs, record.descriptors.frames, matches.view->descriptors.frames, kRotations, {})) {
    const Eigen::Matrix3f R = vote.R_target_query.cast<float>();
    if (gravity && (R * gravity->up_source).dot(gravity->up_target) < gravity->min_cosine) continue;
    rotations.push_back(vote.R_target_query);
  }
  return rotations;
}

// What the slope filter leaves under each rotation. The slopes agree only when both clouds are in
// one orientation.
std::vector<Group> slope_filtered(const SearchInput& input,
                                  const EntryMatches& matches,
                                  const std::vector<Correspondence>& pairs) {
  const DescriptorSet& entry = input.entries[matches.entry].record().descriptors;
  std::vector<Group> groups;
  for (const Eigen::Matrix3d& R : rotations_of(input, matches, pairs)) {
    std::vector<Eigen::Vector3f> turned;
    turned.reserve(matches.view->descriptors.size());
    for (const Eigen::Vector3f& p : matches.view->descriptors.keypoints) {
      turned.push_back(R.cast<float>() * p);
    }
    groups.push_back(filter_slope(pairs, entry.keypoints, turned, {}));
  }
  return groups;
}

// The pairs of any of the groups, once each, by query.
std::vector<Correspondence> all_of(const std::vector<Group>& groups) {
  std::vector<Correspondence> all;
  for (const Group& group : groups) all.insert(all.end(), group.begin(), group.end());
  const auto key = [](const Correspondence& pair) { return std::pair(pair.query, pair.target); };
  std::sort(all.begin(), all.end(), [&](const Correspondence& a, const Correspondence& b) {
    return key(a) < key(b);
  });
  all.erase(std::unique(
                all.begin(),
                all.end(),
                [&](const Correspondence& a, const Correspondence& b) { return key(a) == key(b); }),
            all.end());
  return all;
}

void filter_cliques(const SearchInput& input, const EntryMatches& matches, Group& group) {
  const Entry& entry = input.entries[matches.entry];
  ConsistencyOptions consistency;
  consistency.tolerance_m = kResidualCells * entry.grid.cell_m();
  consistency.min_separation_m = 2.0 * kResidualCells * entry.grid.cell_m();
  group = filter_consistency(group,
                             entry.record().descriptors.keypoints,
                             matches.view->descriptors.keypoints,
                             consistency);
}

// The smallest ratio, in hundredths, that would leave the four pairs a similarity wants; 0: none.
double ratio_for_four(std::span<const DescriptorMatch> found, const RatioRivals& rivals) {
  constexpr int kHundredths = 100;
  constexpr std::size_t kFewest = 4;
  for (int ratio = 1; ratio <= kHundredths; ++ratio) {
    const double share = static_cast<double>(ratio) / kHundredths;
    if (filter_ratio(found, kNeighbours, share, rivals).size() >= kFewest) return share;
  }
  return 0.0;
}

// Nearest neighbours of the query in one entry, and the filters in the paper's order.
std::vector<Group> match_and_filter(const SearchInput& input, EntryMatches& matches) {
  const SceneRecord& record = input.entries[matches.entry].record();
  std::vector<DescriptorMatch> found;
  {
    const StageTimer timer(input.timings.match);
    index_over(input, matches.entry)
        ->search(matches.view->descriptors.values, kNeighbours, found, input.context);
  }
  const StageTimer timer(input.timings.filter);
  matches.putative = nearest_pairs(found, kNeighbours);
  matches.dropped_by.assign(matches.putative.size(), "");
  const auto count = [](const std::vector<Correspondence>& pairs) {
    return static_cast<std::uint32_t>(pairs.size());
  };
  std::vector<Correspondence> pairs = matches.putative;
  matches.counts.putative = count(pairs);
  if (uses(input.options, Filter::kRatio)) {
    const RatioRivals rivals{.target = record.descriptors.keypoints,
                             .apart_m = kRivalApartSupports * record.options.shot_radius_m};
    pairs = filter_ratio(found, kNeighbours, input.options.ratio, rivals);
    if (input.options.explain) matches.ratio_for_four = ratio_for_four(found, rivals);
    mark_dropped(matches, pairs, "ratio");
  }
  matches.counts.after_ratio = count(pairs);
  std::vector<Group> groups{pairs};
  if (uses(input.options, Filter::kSlope)) {
    groups = slope_filtered(input, matches, pairs);
    pairs = all_of(groups);
    mark_dropped(matches, pairs, "slope");
  }
  matches.counts.after_slope = count(pairs);
  if (uses(input.options, Filter::kClique)) {
    for (Group& group : groups) filter_cliques(input, matches, group);
    pairs = all_of(groups);
    mark_dropped(matches, pairs, "clique");
  }
  matches.counts.after_consistency = count(pairs);
  return groups;
}

// The pose of the pairs, as a candidate that names one of its inliers; the rigid part of a
// similarity.
std::optional<Candidate> candidate_of(const SearchInput& input,
                                      std::size_t m,
                                      const EntryMatches& matches,
                                      std::span<const Correspondence> pairs) {
  const StageTimer timer(input.timings.pose);
  const Entry& entry = input.entries[matches.entry];
  PoseOptions options;
  options.max_residual_m = kResidualCells * entry.grid.cell_m();
  options.estimate_scale = input.options.estimate_scale;
  options.seed = input.options.seed;
  const std::vector<Eigen::Vector3f>& target = entry.record().descriptors.keypoints;
  const std::vector<Eigen::Vector3f>& source = matches.view->descriptors.keypoints;
  const std::optional<PoseEstimate> pose =
      input.options.solver == Solver::kPnp
          ? estimate_pose_pnp(
                target, source, input.query.cloud.viewpoints[0].cast<double>(), pairs, options)
          : estimate_pose(target, source, pairs, options);
  if (!pose) return std::nullopt;
  Candidate candidate;
  candidate.matches = m;
  candidate.T_entry_sensor.linear() = pose->T_target_source.R;
  candidate.T_entry_sensor.translation() = pose->T_target_source.t;
  candidate.score = static_cast<float>(pose->inliers.size());
  const Correspondence& inlier = pairs[pose->inliers.front()];
  const auto named =
      std::find_if(matches.putative.begin(), matches.putative.end(), [&](const auto& pair) {
        return pair.query == inlier.query && pair.target == inlier.target;
      });
  candidate.correspondence = static_cast<std::uint32_t>(named - matches.putative.begin());
  return candidate;
}

// Takes out the pairs that the candidate explains.
void drop_agreeing(const SearchInput& input,
                   const EntryMatches& matches,
                   const Candidate& candidate,
                   std::vector<Correspondence>& pairs) {
  const Entry& entry = input.entries[matches.entry];
  std::erase_if(pairs, [&](const Correspondence& pair) {
    const Eigen::Vector3d there =
        candidate.T_entry_sensor * matches.view->descriptors.keypoints[pair.query].cast<double>();
    return (there - entry.record().descriptors.keypoints[pair.target].cast<double>()).norm() <=
           kResidualCells * entry.grid.cell_m();
  });
}

}  // namespace

void search_paper(const SearchInput& input, SearchResult& result) {
  std::vector<Candidate> candidates;
  std::vector<std::size_t> asked;
  for (std::size_t e = 0; e < input.entries.size(); ++e) {
    if (input.wanted[e]) asked.push_back(e);
  }
  {
    const StageTimer timer(input.timings.load);
    input.entries.load(asked, SceneParts::kWhole, input.context);
  }
  for (const std::size_t e : asked) {
    if (input.entries.is_damaged(e)) continue;
    // The query is described as the entry was, keypoints and all: NARF where that has NARF.
    const QueryView& view =
        input.views.at(query_features(input.entries[e].record().options, input.options));
    if (view.descriptors.size() == 0) continue;
    EntryMatches& matches = result.matches.emplace_back();
    matches.entry = e;
    matches.view = &view;
    std::vector<Group> groups = match_and_filter(input, matches);
    const int motions = uses(input.options, Filter::kSlope) ? kMotionsEach : kMotionsUnturned;
    for (Group& group : groups) {
      input.context.check("pose");
      // A second and a third motion of the pairs that are left are the rivals the first is held
      // against.
      for (int motion = 0; motion < motions; ++motion) {
        const auto candidate = candidate_of(input, result.matches.size() - 1, matches, group);
        if (!candidate) break;
        candidates.push_back(*candidate);
        ++matches.poses.proposals;
        ++matches.poses.survivors;
        drop_agreeing(input, matches, *candidate, group);
      }
    }
  }
  if (candidates.empty()) {
    result.lost_at = result.matches.empty() ? "keypoints" : "filter";
    return;
  }
  assess_candidates(
      input,
      std::move(candidates),
      [&](const EntryMatches& matches) {
        return Meeting{.target = input.entries[matches.entry].grid,
                       .source = matches.view->sample_points,
                       .source_normals = matches.view->sample_normals,
                       .precise = matches.view->precise_points,
                       .precise_normals = matches.view->precise_normals};
      },
      result);
}

}  // namespace landmarkdb
