#include "engine/mono/corner_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "engine/mono/refine_pose.hpp"
#include "engine/mono/triple_pose.hpp"

namespace landmarkdb {
namespace {

// Poses asked in one search, some 0.5 us each, and those drawn onto the edges, some 0.2 ms each;
// shared among the models.
constexpr std::size_t kMostPoses = 120'000;
constexpr std::size_t kMostDrawn = 120;
constexpr double kEnoughShare = 0.6;   // of the outline: a raw pose is a few pixels off
constexpr double kMeet_px = 6.0;       // from a corner to the end of an edge of it
constexpr double kShortest_px = 12.0;  // of an edge that a pose can stand on
constexpr double kLeastCosTilt = 0.15;

// Two edges of the image that meet in a corner: rays of the corner and the far ends.
struct ImageCorner {
  std::array<Eigen::Vector2d, 3> rays;
  double size_px = 0.0;  // of the shorter edge
};

struct Arm {
  Eigen::Vector2d end;
  double length_px;
};

std::vector<Arm> arms_of(const ImageFeatures& features,
                         const Eigen::Vector2d& corner,
                         double scale) {
  std::vector<Arm> arms;
  for (const ImageSegment& segment : features.segments) {
    for (const auto& [near, far] :
         {std::pair(segment.from, segment.to), std::pair(segment.to, segment.from)}) {
      const double length = (far - corner).norm();
      if ((near - corner).norm() > kMeet_px * scale || length < kShortest_px * scale) continue;
      arms.push_back({far, length});
    }
  }
  // An end near a corner is that corner: its place is the better one.
  for (Arm& arm : arms) {
    double least = kMeet_px * scale;
    for (const ImageFeature& feature : features.points) {
      if (feature.type != FeatureType::kVertex) continue;
      const double distance = (feature.uv - arm.end).norm();
      if (distance >= least || (feature.uv - corner).norm() < kShortest_px * scale) continue;
      least = distance;
      arm.end = feature.uv;
    }
  }
  return arms;
}

// All pairs of arms in both orders, the largest corners first.
std::vector<ImageCorner> corners_of(const ImageFeatures& features,
                                    const Camera& camera,
                                    double scale) {
  constexpr double kLeastSine = 0.1;  // 6 degrees
  std::vector<ImageCorner> corners;
  for (const ImageFeature& feature : features.points) {
    if (feature.type != FeatureType::kVertex) continue;
    const std::optional<Eigen::Vector2d> at = undistort(camera, feature.uv);
    if (!at) continue;
    const std::vector<Arm> arms = arms_of(features, feature.uv, scale);
    for (const Arm& a : arms) {
      for (const Arm& b : arms) {
        const Eigen::Vector2d da = a.end - feature.uv, db = b.end - feature.uv;
        const double sine = std::abs(da.x() * db.y() - da.y() * db.x()) / (da.norm() * db.norm());
        if (!(sine >= kLeastSine)) continue;
        const std::optional<Eigen::Vector2d> end_a = undistort(camera, a.end);
        const std::optional<Eigen::Vector2d> end_b = undistort(camera, b.end);
        if (end_a && end_b) {
          corners.push_back({{*at, *end_a, *end_b}, std::min(a.length_px, b.length_px)});
        }
      }
    }
  }
  std::stable_sort(corners.begin(), corners.end(), [](const ImageCorner& a, const ImageCorner& b) {
    return a.size_px > b.size_px;
  });
  return corners;
}

std::uint32_t nearest_point(const MonoModel& model, const Eigen::Vector3d& xyz) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < model.points.size(); ++i) {
    if ((model.points[i].xyz - xyz).squaredNorm() < (model.points[best].xyz - xyz).squaredNorm()) {
      best = i;
    }
  }
  return best;
}

struct Proposal {
  double share;
  std::uint32_t model;
  RigidPose pose;
};

// The poses of one model whose outline agrees with the image's edges.
class Proposer {
 public:
  Proposer(std::uint32_t number,
           const SearchModel& search,
           const EdgeOutline& outline,
           const Camera& camera,
           const EdgeDirections& edges,
           const CornerSearchOptions& options)
      : number_(number),
        search_(search),
        outline_(outline),
        camera_(camera),
        edges_(edges),
        options_(options) {}

  void propose(const ModelTriple& triple,
               const ImageCorner& corner,
               std::vector<Proposal>& proposals) const {
    constexpr int kRounds = 2;  // section 3.3: enough to look
    const TriplePoses poses = solve_triple_in_sight(triple, corner.rays);
    if (poses.status != PoseStatus::kOk || poses.cos_tilt < kLeastCosTilt) return;
    if (poses.depth_m < options_.min_depth_m || poses.depth_m > options_.max_depth_m) return;
    const std::array<Eigen::Vector3d, 3> points = {search_.points[triple.points[0]].xyz,
                                                   search_.points[triple.points[1]].xyz,
                                                   search_.points[triple.points[2]].xyz};
    for (int k = 0; k < poses.count; ++k) {
      const RigidPose pose = correct_perspective(
          triple, points, corner.rays, poses.poses[static_cast<std::size_t>(k)], kRounds);
      if (!pose.t.allFinite() || !pose.R.allFinite()) continue;
      const double share = outline_.share(pose, camera_, edges_, kEnoughShare);
      if (share >= kEnoughShare) proposals.push_back({share, number_, pose});
    }
  }

 private:
  std::uint32_t number_;
  const SearchModel& search_;
  const EdgeOutline& outline_;
  const Camera& camera_;
  const EdgeDirections& edges_;
  const CornerSearchOptions& options_;
};

// Draws a pose onto the image's edges, from further off in each round less; where that fails the
// pose stays.
RigidPose drawn_onto_edges(const SearchModel& search,
                           const RigidPose& start,
                           const Camera& camera,
                           const EdgeGrid& edges,
                           double scale) {
  constexpr std::array<double, 4> kReach_px{10.0, 8.0, 6.0, 4.0};
  constexpr double kStep_px = 10.0;
  constexpr std::size_t kMostSamples = 150;
  constexpr double kCosine = 0.906;  // 25 degrees
  RefineOptions options;
  options.huber = 2.0;
  options.max_steps = 3;
  RigidPose pose = start;
  for (const double reach : kReach_px) {
    std::vector<PoseEdge> along;
    for (const EdgeSample& sample :
         visible_edges(search, camera, pose, kStep_px * scale, kMostSamples)) {
      const EdgePoint* edge = edges.nearest(sample.uv, sample.normal, reach * scale, kCosine);
      if (edge == nullptr) continue;
      along.push_back({sample.xyz, edge->uv.cast<double>(), sample.normal, 1.0});
    }
    RefineState state;
    if (!start_refinement({}, along, camera, pose, options, state)) break;
    refine_steps({}, along, camera, options, options.max_steps, state);
    if (!state.pose.t.allFinite() || !state.pose.R.allFinite()) break;
    pose = state.pose;
  }
  return pose;
}

// The best of each model's share, best first; the same pose is drawn once.
std::vector<Proposal> best_of(std::vector<Proposal> proposals,
                              std::span<const SearchModel> models,
                              std::size_t most) {
  constexpr double kSameAngle_rad = 0.09;  // 5 degrees
  constexpr double kSameDistance = 0.03;   // of the depth
  std::stable_sort(proposals.begin(), proposals.end(), [](const Proposal& a, const Proposal& b) {
    return a.share > b.share;
  });
  std::vector<Proposal> kept;
  for (const Proposal& proposal : proposals) {
    if (kept.size() == most) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Proposal& other) {
      return other.model == proposal.model &&
             same_but_for_symmetry(models[other.model],
                                   other.pose,
                                   proposal.pose,
                                   kSameAngle_rad,
                                   kSameDistance * other.pose.t.norm());
    });
    if (!known) kept.push_back(proposal);
  }
  return kept;
}

}  // namespace

CornerModel prepare_corners(const SearchModel& search) {
  const MonoModel& model = search.model();
  CornerModel prepared;
  std::set<std::array<std::uint32_t, 3>> known;
  for (const ModelTriple& triple : search.record->triples) {
    const auto [i0, i1, i2] = triple.points;
    if (!search.linked(i0, i1) || !search.linked(i0, i2)) continue;
    if (known.contains(triple.points)) continue;
    prepared.corners.push_back(triple);
    for (const Eigen::Matrix4d& T : model.symmetries) {
      std::array<std::uint32_t, 3> image{};
      for (std::size_t k = 0; k < 3; ++k) {
        image[k] =
            nearest_point(model, (T * model.points[triple.points[k]].xyz.homogeneous()).head<3>());
      }
      if (image[1] > image[2]) std::swap(image[1], image[2]);
      known.insert(image);
    }
  }
  if (!prepared.corners.empty()) prepared.outline.emplace(search);
  return prepared;
}

bool search_by_corners(std::span<const SearchModel> models,
                       std::span<const CornerModel> corner_models,
                       const ImageFeatures& features,
                       const Camera& camera,
                       const EdgeGrid& edges,
                       const CornerSearchOptions& options,
                       const RunContext& run,
                       CandidatePool& pool) {
  const EdgeDirections directions(features);
  if (directions.empty()) return true;
  const std::vector<ImageCorner> corners = corners_of(features, camera, options.scale);
  const std::size_t asked =
      static_cast<std::size_t>(std::count(options.wanted.begin(), options.wanted.end(), 1));
  if (corners.empty() || asked == 0) return true;
  bool complete = true;
  std::vector<Proposal> chosen;
  for (std::uint32_t m = 0; m < models.size(); ++m) {
    if (options.wanted[m] == 0) continue;
    run.check("verify");
    const std::vector<ModelTriple>& triples = corner_models[m].corners;
    if (triples.empty()) continue;
    const Proposer proposer(m, models[m], *corner_models[m].outline, camera, directions, options);
    const std::size_t most = std::max<std::size_t>(1, kMostPoses / asked / triples.size() / 2);
    complete = complete && corners.size() <= most;
    std::vector<Proposal> proposals;
    for (std::size_t i = 0; i < std::min(most, corners.size()); ++i) {
      for (const ModelTriple& triple : triples) proposer.propose(triple, corners[i], proposals);
    }
    const std::vector<Proposal> best =
        best_of(std::move(proposals), models, std::max<std::size_t>(1, kMostDrawn / asked));
    chosen.insert(chosen.end(), best.begin(), best.end());
  }
  pool.renew_allowance();
  for (const Proposal& proposal : chosen) {
    run.check("verify");
    pool.try_pose(
        proposal.model,
        drawn_onto_edges(models[proposal.model], proposal.pose, camera, edges, options.scale));
  }
  return complete;
}

}  // namespace landmarkdb
