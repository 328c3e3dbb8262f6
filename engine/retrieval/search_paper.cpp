#include <algorithm>
#include <optional>
#include <utility>

#include "engine/matching/descriptor_index.hpp"
#include "engine/matching/filters.hpp"
#include "engine/matching/rotation_from_frames.hpp"
#include "engine/registration/consistency.hpp"
#include "engine/registration/estimate_pose.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kNeighbours = 2;  // the nearest and the one it is held against

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

std::vector<Correspondence> slope_filtered(const std::vector<Correspondence>& pairs,
                                           const DescriptorSet& entry,
                                           const DescriptorSet& query) {
  const std::optional<RotationVote> vote =
      rotation_from_frames(pairs, entry.frames, query.frames, {});
  if (!vote) return {};
  // The slopes agree only when both clouds are in one orientation.
  const Eigen::Matrix3f R = vote->R_target_query.cast<float>();
  std::vector<Eigen::Vector3f> turned;
  turned.reserve(query.keypoints.size());
  for (const Eigen::Vector3f& p : query.keypoints) turned.push_back(R * p);
  return filter_slope(pairs, entry.keypoints, turned, {});
}

// The smallest ratio, in hundredths, that would leave the four pairs a similarity wants; 0: none.
double ratio_for_four(std::span<const DescriptorMatch> found) {
  constexpr int kHundredths = 100;
  constexpr std::size_t kFewest = 4;
  for (int ratio = 1; ratio <= kHundredths; ++ratio) {
    const double share = static_cast<double>(ratio) / kHundredths;
    if (filter_ratio(found, kNeighbours, share).size() >= kFewest) return share;
  }
  return 0.0;
}

// Nearest neighbours of the query in one entry, and the filters in the paper's order.
std::vector<Correspondence> match_and_filter(const SearchInput& input, EntryMatches& matches) {
  const DescriptorSet& entry = input.entries[matches.entry].record().descriptors;
  const DescriptorSet& query = matches.view->descriptors;
  std::vector<DescriptorMatch> found;
  {
    const StageTimer timer(input.timings.match);
    make_index(input.entries[matches.entry].record().descriptors.values, input.options)
        ->search(query.values, kNeighbours, found, input.context);
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
    pairs = filter_ratio(found, kNeighbours, input.options.ratio);
    if (input.options.explain) matches.ratio_for_four = ratio_for_four(found);
    mark_dropped(matches, pairs, "ratio");
  }
  matches.counts.after_ratio = count(pairs);
  if (uses(input.options, Filter::kSlope)) {
    pairs = slope_filtered(pairs, entry, query);
    mark_dropped(matches, pairs, "slope");
  }
  matches.counts.after_slope = count(pairs);
  if (uses(input.options, Filter::kClique)) {
    ConsistencyOptions consistency;
    const double cell_m = input.entries[matches.entry].grid.cell_m();
    consistency.tolerance_m = kResidualCells * cell_m;
    consistency.min_separation_m = 2.0 * kResidualCells * cell_m;
    pairs = filter_consistency(pairs, entry.keypoints, query.keypoints, consistency);
    mark_dropped(matches, pairs, "clique");
  }
  matches.counts.after_consistency = count(pairs);
  return pairs;
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
  const std::optional<PoseEstimate> pose = estimate_pose(
      entry.record().descriptors.keypoints, matches.view->descriptors.keypoints, pairs, options);
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
  for (std::size_t e = 0; e < input.entries.size(); ++e) {
    if (!input.wanted[e]) continue;
    FeatureOptions features = query_features(input.entries[e].record().options, input.options);
    if (!input.options.keypoints) features.keypoints = KeypointMethod::kNarf;
    const QueryView& view = input.views.at(features);
    if (view.descriptors.size() == 0) continue;
    EntryMatches& matches = result.matches.emplace_back();
    matches.entry = e;
    matches.view = &view;
    std::vector<Correspondence> pairs = match_and_filter(input, matches);
    // A second and a third motion of the pairs that are left are the rivals the first is held
    // against.
    constexpr int kMotions = 3;
    for (int motion = 0; motion < kMotions; ++motion) {
      const auto candidate = candidate_of(input, result.matches.size() - 1, matches, pairs);
      if (!candidate) break;
      candidates.push_back(*candidate);
      ++matches.poses.proposals;
      ++matches.poses.survivors;
      drop_agreeing(input, matches, *candidate, pairs);
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
                       .source_normals = matches.view->sample_normals};
      },
      result);
}

}  // namespace landmarkdb
