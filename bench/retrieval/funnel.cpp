#include "bench/retrieval/funnel.hpp"

#include <algorithm>
#include <vector>

#include "engine/geometry/pose.hpp"
#include "engine/registration/propose.hpp"
#include "engine/retrieval/index_cache.hpp"
#include "engine/retrieval/query_view.hpp"
#include "engine/retrieval/rank_poses.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb::bench {

namespace {

constexpr double kNearMetres = 0.5;
constexpr double kNearRad = 0.21;
constexpr double kLooseMetres = 0.8;
constexpr double kLooseRad = 0.436;
constexpr double kRightMetres = 0.10;
constexpr double kRightRad = 0.0873;

bool within(const Eigen::Isometry3d& T, const Eigen::Isometry3d& truth, double metres, double rad) {
  return (T.translation() - truth.translation()).norm() <= metres &&
         rotation_angle_rad(truth.linear().transpose() * T.linear()) <= rad;
}

Eigen::Isometry3d pose_of(const Proposal& proposal) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = proposal.R_target_source.cast<double>();
  T.translation() = proposal.t_target_source.cast<double>();
  return T;
}

}  // namespace

Funnel follow(const PointCloud& cloud,
              const QueryOptions& options,
              const std::vector<Entry>& entries,
              std::span<const Level> levels,
              std::size_t right_entry,
              const Eigen::Isometry3d& T_scene_sensor,
              const RunContext& context) {
  Funnel funnel;
  StageTimings timings;
  const CleanQuery query = clean_query(cloud);
  ViewCache views(query, options.seed, context, timings);
  const std::vector<bool> wanted(entries.size(), true);
  IndexCache indexes;
  Entries seen(entries);
  const SearchInput input{query, options, seen, levels, wanted, views, indexes, timings, context};
  SearchResult result;
  search_places(input, result);
  const Entry& entry = entries[right_entry];
  Eigen::Isometry3d truth = T_scene_sensor;
  truth.translation() -= entry.record().prepared.origin;
  for (const EntryMatches& matches : result.matches) {
    if (matches.entry != right_entry) continue;
    const auto proposals = propose(input, matches);
    funnel.keypoints = matches.view->descriptors.size();
    funnel.proposals = proposals.size();
    for (const Proposal& proposal : proposals) {
      funnel.near_proposals += within(pose_of(proposal), truth, kNearMetres, kNearRad) ? 1U : 0U;
      funnel.loose_proposals +=
          same_pose(pose_of(proposal), truth, query.centre, kLooseMetres, kLooseRad) ? 1U : 0U;
    }
    const auto settled = settle_best(
        entry.wide, entry.grid, matches.view->test, proposals, query.centre, {}, context);
    const auto ranked = rank_poses(entry.grid,
                                   matches.view->test,
                                   settled,
                                   query.centre,
                                   {.scanned = &entry.scanned},
                                   context);
    for (std::size_t i = 0; i < ranked.size() && funnel.ranked < 0; ++i) {
      if (within(ranked[i].T_target_source, truth, kNearMetres, kNearRad))
        funnel.ranked = static_cast<int>(i);
    }
  }
  const QueryView& view = views.at(query_features(entry.record().options, options));
  if (view.prepared.size() > 0) {
    const Meeting meeting{.target = entry.grid,
                          .source = view.sample_points,
                          .source_normals = view.sample_normals,
                          .tolerance_m = common_tolerance_m(input, entry),
                          .precise = view.precise_points,
                          .precise_normals = view.precise_normals};
    Assessed from_truth = assess_coarse(meeting, entry, query, truth);
    assess_fine(meeting, entry, query, from_truth);
    assess_precisely(meeting, entry, query, from_truth);
    funnel.truth_score = from_truth.score;
    funnel.truth_drift_m = (from_truth.T_entry_sensor.translation() - truth.translation()).norm();
  }
  std::sort(result.poses.begin(), result.poses.end(), [](const Assessed& a, const Assessed& b) {
    return a.score > b.score;
  });
  if (!result.poses.empty()) funnel.best_score = result.poses.front().score;
  for (const Assessed& pose : result.poses) {
    if (pose.entry != right_entry) continue;
    funnel.nearest_m = std::min(funnel.nearest_m,
                                (pose.T_entry_sensor.translation() - truth.translation()).norm());
  }
  for (std::size_t i = 0; i < result.poses.size() && funnel.assessed < 0; ++i) {
    const Assessed& pose = result.poses[i];
    if (pose.entry == right_entry && within(pose.T_entry_sensor, truth, kRightMetres, kRightRad)) {
      funnel.assessed = static_cast<int>(i);
    }
  }
  return funnel;
}

}  // namespace landmarkdb::bench
