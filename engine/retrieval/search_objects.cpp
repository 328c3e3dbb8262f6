#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/registration/propose.hpp"
#include "engine/retrieval/object_evidence.hpp"
#include "engine/retrieval/rank_poses.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kNeighbours = 30;
// Half of an object faces away and clutter hides more: a third of its points found is a good start.
constexpr float kHopeless = 0.08F;
// Distinct poses of an object that go on to refinement, where only what must be seen counts.
constexpr std::size_t kKept = 40;
// Of the proposals of an object, which has less room than a place.
constexpr std::size_t kSettled = 800;
// An object is seen over some degrees only, and its outline is what tells it: a third of a
// degree, three pixels of a depth camera, 5 mm at a metre.
constexpr double kSightStepRad = 0.3 * std::numbers::pi / 180.0;

// What objects of one resolution are held against.
struct QuerySurface {
  SurfaceGrid fine;
  SurfaceGrid wide;
  std::unique_ptr<const DescriptorIndex> descriptors;
};

std::unique_ptr<QuerySurface> make_surface(const SearchInput& input, const QueryView& view) {
  const auto grids = [&] {
    const StageTimer timer(input.timings.preprocess);
    return std::pair{make_grid(view.prepared, input.context),
                     make_wide_grid(view.prepared, input.context)};
  };
  auto [fine, wide] = grids();
  const StageTimer timer(input.timings.match);
  auto descriptors = make_exact_index(view.descriptors.values, Measure::kL2);
  return std::make_unique<QuerySurface>(
      QuerySurface{std::move(fine), std::move(wide), std::move(descriptors)});
}

// Looks each of the object's descriptors up among the query's: the object is whole, the query is
// clutter.
EntryMatches match_object(const SearchInput& input,
                          std::size_t e,
                          const QueryView& view,
                          const DescriptorIndex& index) {
  const StageTimer timer(input.timings.match);
  EntryMatches matches;
  matches.entry = e;
  matches.view = &view;
  std::vector<DescriptorMatch> found;
  index.search(input.entries[e].record().descriptors.values, kNeighbours, found, input.context);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].index == DescriptorMatch::kNone) continue;
    matches.putative.push_back(
        {found[i].index, static_cast<std::uint32_t>(i / kNeighbours), found[i].distance});
  }
  matches.counts.putative = static_cast<std::uint32_t>(matches.putative.size());
  return matches;
}

// Proposals of the object in the query: the pairs turned round.
std::vector<Proposal> propose_object(const EntryMatches& matches, const Entry& entry) {
  std::vector<Correspondence> turned = matches.putative;
  for (Correspondence& pair : turned) std::swap(pair.query, pair.target);
  return propose_from_frames(
      turned, matches.view->descriptors, entry.record().descriptors, std::nullopt, std::nullopt);
}

Eigen::Vector3d centre_of(const PreparedCloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& point : cloud.points) sum += point.cast<double>();
  return sum / static_cast<double>(std::max<std::size_t>(cloud.size(), 1));
}

// What the descriptors say of the poses from `begin` on.
void ask_descriptors(const SearchInput& input,
                     std::size_t begin,
                     const MeetingOf& meeting_of,
                     SearchResult& result) {
  const StageTimer timer(input.timings.verify);
  const std::span poses = std::span(result.poses).subspan(begin);
  parallel_chunks(poses.size(), input.context.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      input.context.check("verify");
      const EntryMatches& matches = result.matches[poses[i].matches];
      poses[i].evidence.confirmed = confirmed_share(meeting_of(matches),
                                                    input.entries[matches.entry],
                                                    input.query,
                                                    matches,
                                                    poses[i].T_entry_sensor);
    }
  });
}

}  // namespace

void search_objects(const SearchInput& input, SearchResult& result) {
  std::vector<Candidate> candidates;
  std::unordered_map<const QueryView*, std::unique_ptr<QuerySurface>> surfaces;
  for (std::size_t e = 0; e < input.entries.size(); ++e) {
    const Entry& entry = input.entries[e];
    if (!entry.is_object() || !input.wanted[e] || input.entries.is_damaged(e)) continue;
    input.context.check("pose");
    const QueryView& view = input.views.dense_at(entry.record().options);
    if (view.prepared.size() == 0) {
      result.lost_at = "density";
      if (result.needs_voxel_m == 0.0)
        result.needs_voxel_m = input.query.scale.spacing_m / kMostSpacingVoxels;
      continue;
    }
    if (view.descriptors.size() == 0) continue;
    auto& surface = surfaces[&view];
    if (!surface) surface = make_surface(input, view);
    result.matches.push_back(match_object(input, e, view, *surface->descriptors));
    const StageTimer timer(input.timings.pose);
    const Eigen::Vector3d centre = centre_of(entry.record().prepared);
    const std::vector<Proposal> proposals = propose_object(result.matches.back(), entry);
    PoseCounts& counts = result.matches.back().poses;
    counts.proposals = proposals.size();
    SettleBestOptions settle;
    settle.hopeless = kHopeless;
    settle.kept = kSettled;
    RankOptions rank;
    rank.hopeless = kHopeless;
    rank.kept_last = kKept;
    for (const RankedPose& ranked : rank_poses(surface->fine,
                                               entry.test,
                                               settle_best(surface->wide,
                                                           surface->fine,
                                                           entry.test,
                                                           proposals,
                                                           centre,
                                                           settle,
                                                           input.context),
                                               centre,
                                               rank,
                                               input.context)) {
      ++counts.survivors;
      candidates.push_back({result.matches.size() - 1,
                            ranked.T_target_source.inverse(),
                            ranked.score,
                            ranked.correspondence});
    }
  }
  if (candidates.empty()) {
    if (result.lost_at.empty()) result.lost_at = result.matches.empty() ? "keypoints" : "pose";
    return;
  }
  const std::vector<RangeImage> ranges = range_images(input.query.cloud, kSightStepRad);
  const auto meeting_of = [&](const EntryMatches& matches) {
    const PreparedCloud& object = input.entries[matches.entry].record().prepared;
    return Meeting{.target = surfaces.at(matches.view)->fine,
                   .source = object.points,
                   .source_normals = object.normals,
                   .entry_is_source = true,
                   .ranges = ranges,
                   .noise = &matches.view->noise};
  };
  const std::size_t before = result.poses.size();
  assess_candidates(input, std::move(candidates), meeting_of, result);
  ask_descriptors(input, before, meeting_of, result);
}

}  // namespace landmarkdb
