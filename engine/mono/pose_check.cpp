#include "engine/mono/pose_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/mono/chance_score.hpp"
#include "engine/mono/face_rival.hpp"
#include "engine/mono/point_pose.hpp"
#include "engine/mono/refine_pose.hpp"
#include "engine/mono/stretched_rival.hpp"

namespace landmarkdb {
namespace {

// Tolerances in pixels of a 640 pixels wide image: the quick look, then after each refinement.
constexpr double kLook_px = 8.0;
constexpr std::array<double, 3> kRounds_px{5.0, 3.5, 3.5};
constexpr double kUnlike = 0.015;  // of the diameter: how far a thing's corners are off its model's
constexpr double kLeastShare = 0.35;  // of the visible points
constexpr double kHuber = 2.0;        // sigmas

constexpr std::size_t kGrowFrom = 7;  // points that agree before a pose is refined to find more

// Matches that a pose of so many visible points has to show at first sight.
std::size_t hits_needed(std::size_t visible) {
  return std::max(kLeastHits,
                  static_cast<std::size_t>(std::ceil(kLeastShare * static_cast<double>(visible))));
}

// Faces have a centroid in the image and arcs an inflexion only where nothing is printed on them or
// runs across. A type of these that no feature matched is not expected then: what is judged is the
// corners and circles. True when some were left out.
bool leave_out_unseen_types(const MonoModel& model,
                            std::span<const Match> matches,
                            std::vector<std::uint16_t>& seen) {
  const std::size_t before = seen.size();
  for (const FeatureType type : {FeatureType::kCentroid, FeatureType::kInflexion}) {
    const auto is_of_type = [&](std::uint16_t id) { return model.points[id].type == type; };
    const bool matched = std::any_of(matches.begin(), matches.end(), [&](const Match& match) {
      return is_of_type(match.model);
    });
    if (!matched) std::erase_if(seen, is_of_type);
  }
  return seen.size() != before;
}

}  // namespace

PoseCheck::PoseCheck(std::span<const SearchModel> models,
                     const ImageView& image,
                     const EdgeGrid& edges,
                     const Camera& camera,
                     const CheckOptions& options)
    : models_(models),
      image_(image),
      edges_(edges),
      camera_(camera),
      options_(options),
      marks_(image.size(), 0),
      marks_distance_(image.size(), 0.0F) {}

std::size_t PoseCheck::collect(std::uint32_t model,
                               const RigidPose& pose,
                               std::span<const std::uint16_t> seen,
                               double reach_px,
                               std::size_t need) {
  const SearchModel& search = models_[model];
  const double reach2 = reach_px * reach_px;
  matches_.clear();
  ++call_;
  std::size_t left = seen.size();
  for (const std::uint16_t id : seen) {
    if (matches_.size() + left < need) break;
    --left;
    const PosePoint& point = search.points[id];
    Eigen::Vector2d xy;
    if (point.radius_m > 0.0) {
      const SeenRay ray = seen_ray(point, pose);
      if (!ray.ok) continue;
      xy = image_.focal_px() * ray.ray;
    } else {
      const Eigen::Vector3d X = pose * point.xyz;
      if (!(X.z() > 0.0)) continue;
      xy = straight_px(image_, X);
    }
    const int at = image_.nearest(static_cast<std::uint8_t>(search.model().points[id].type), xy);
    if (at < 0) continue;
    const std::size_t i = static_cast<std::size_t>(at);
    const double d2 = (image_[i].xy - xy).squaredNorm();
    if (d2 > reach2) continue;
    const float distance = static_cast<float>(std::sqrt(d2));
    if (marks_[i] == call_) {  // two of the model's points at one feature: the nearer has it
      if (distance >= marks_distance_[i]) continue;
      for (Match& match : matches_) {
        if (match.image == i) match = {id, static_cast<std::uint16_t>(i), distance};
      }
    } else {
      marks_[i] = call_;
      matches_.push_back({id, static_cast<std::uint16_t>(i), distance});
    }
    marks_distance_[i] = distance;
  }
  return matches_.size();
}

// The points of the view nearest to the pose; nullptr where the pose is out of the depth range.
const std::vector<std::uint16_t>* PoseCheck::seen_at(std::uint32_t model,
                                                     const RigidPose& pose) const {
  const SearchModel& search = models_[model];
  const double depth = (pose * search.center).z();
  if (!(depth >= options_.min_depth_m) || !(depth <= options_.max_depth_m)) return nullptr;
  return &search.seen[nearest_view(-(pose.R.transpose() * pose.t) - search.center)];
}

std::size_t PoseCheck::count_near(std::uint32_t model, const RigidPose& pose) {
  const std::vector<std::uint16_t>* seen = seen_at(model, pose);
  if (seen == nullptr) return 0;
  const std::size_t need = std::min(kGrowFrom, hits_needed(seen->size()));
  const std::size_t hits = collect(model, pose, *seen, kLook_px * options_.scale, need);
  return hits < need ? 0 : hits;
}

std::span<const Match> PoseCheck::look(std::uint32_t model, const RigidPose& pose) {
  ++looks_;
  const std::vector<std::uint16_t>* seen = seen_at(model, pose);
  if (seen == nullptr) return {};
  const std::size_t need = hits_needed(seen->size());
  if (seen->size() < need || collect(model, pose, *seen, kLook_px * options_.scale, need) < need)
    return {};
  return matches_;
}

std::span<const Match> PoseCheck::grow(std::uint32_t model, RigidPose& pose) {
  constexpr int kRounds = 5;
  std::size_t before = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::uint16_t>* seen = seen_at(model, pose);
    if (seen == nullptr) return {};
    const std::size_t hits =
        collect(model, pose, *seen, kLook_px * options_.scale, std::max(before + 1, kGrowFrom));
    if (hits < kGrowFrom || hits <= before) return {};
    if (hits >= hits_needed(seen->size())) return matches_;
    before = hits;
    if (!refine(model, pose, nullptr)) return {};
  }
  return {};
}

// A tolerance of the image and that of the model, as it is seen at the pose.
double PoseCheck::reach_px(std::uint32_t model,
                           const RigidPose& pose,
                           double image_px,
                           double unlike) const {
  const SearchModel& search = models_[model];
  const double depth = std::max(options_.min_depth_m, (pose * search.center).z());
  const double unlike_px = unlike * image_.focal_px() * search.model().diameter_m / depth;
  return std::hypot(image_px * options_.scale, unlike_px);
}

bool PoseCheck::refine(std::uint32_t model, RigidPose& pose, MonoCandidate* result) const {
  std::vector<PosePoint> points;
  points.reserve(matches_.size());
  for (const Match& match : matches_) {
    PosePoint point = models_[model].points[match.model];
    point.uv = image_[match.image].uv;
    point.sigma_px = image_[match.image].sigma_px;
    points.push_back(point);
  }
  RefineOptions options;
  options.huber = kHuber;
  RefineState state;
  if (!start_refinement(points, {}, camera_, pose, options, state)) return false;
  refine_steps(points, {}, camera_, options, result == nullptr ? 6 : options.max_steps, state);
  pose = state.pose;
  if (result != nullptr) result->covariance = pose_covariance(state.equations);
  return pose.t.allFinite();
}

std::optional<MonoCandidate> PoseCheck::settle(std::uint32_t model,
                                               const RigidPose& start,
                                               std::span<const Match> first) {
  std::optional<MonoCandidate> exact = settle_within(model, start, first, 0.0);
  if (edges_.empty() || (exact && exact->matches.size() == exact->visible)) return exact;
  std::optional<MonoCandidate> unlike = settle_within(model, start, first, kUnlike);
  if (!exact || (unlike && unlike->rank() < exact->rank())) return unlike;
  return exact;
}

std::optional<MonoCandidate> PoseCheck::settle_within(std::uint32_t model,
                                                      const RigidPose& start,
                                                      std::span<const Match> first,
                                                      double unlike) {
  const SearchModel& search = models_[model];
  matches_.assign(first.begin(), first.end());
  MonoCandidate candidate;
  candidate.model = model;
  candidate.pose = start;
  std::vector<std::uint16_t> seen;
  for (std::size_t round = 0; round < kRounds_px.size(); ++round) {
    if (!refine(model, candidate.pose, nullptr)) return std::nullopt;
    const Eigen::Vector3d eye = -(candidate.pose.R.transpose() * candidate.pose.t);
    if (round + 1 < kRounds_px.size()) {
      seen = search.seen[nearest_view(eye - search.center)];
    } else {
      const std::vector<bool> exact = search.visibility.points_from(eye);
      seen.clear();
      for (std::size_t i = 0; i < exact.size(); ++i) {
        if (exact[i]) seen.push_back(static_cast<std::uint16_t>(i));
      }
    }
    const double reach = reach_px(model, candidate.pose, kRounds_px[round], unlike);
    if (collect(model, candidate.pose, seen, reach, 0) < kLeastHits) return std::nullopt;
  }
  if (!refine(model, candidate.pose, &candidate)) return std::nullopt;
  const double depth = (candidate.pose * search.center).z();
  if (!(depth >= options_.min_depth_m) || !(depth <= options_.max_depth_m)) return std::nullopt;
  const bool all_expected = !leave_out_unseen_types(search.model(), matches_, seen);
  candidate.unlike = unlike > 0.0;
  candidate.visible = seen.size();
  candidate.matches = matches_;
  double sum = 0.0;
  for (Match& match : candidate.matches) {
    const SeenRay ray = seen_ray(search.points[match.model], candidate.pose);
    if (!ray.ok) return std::nullopt;
    const double d = (distort(camera_, ray.ray) - image_[match.image].uv).norm();
    match.distance_px = static_cast<float>(d);
    sum += d * d;
  }
  candidate.rms_px = std::sqrt(sum / static_cast<double>(candidate.matches.size()));
  candidate.log10_nfa = log10_false_alarms(candidate,
                                           models_[model],
                                           image_,
                                           seen,
                                           reach_px(model, candidate.pose, kFinal_px, unlike),
                                           options_);
  if (!all_expected) candidate.log10_nfa += std::log10(2.0);  // two ways to count were tried
  if (!edges_.empty()) {
    constexpr double kStep_px = 12.0;
    constexpr std::size_t kMostSamples = 200;
    const std::vector<EdgeSample> samples =
        visible_edges(search, camera_, candidate.pose, kStep_px * options_.scale, kMostSamples);
    candidate.edge_share = edge_share(samples, edges_);
    candidate.edge_odds = score_edges(samples.size(), kStep_px, candidate.edge_share);
  }
  return candidate;
}

// How much likelier this share of its edges is where the model stands than where something else
// has made it fit: log10, negative for the model.
double PoseCheck::score_edges(std::size_t samples, double step_px, double share) const {
  // Samples of one straight edge come and go together: so much of it counts as one trial.
  constexpr double kTogether_px = 48.0;
  constexpr double kOfRight =
      0.85;  // of a model that is there: parts have no contrast, or are hidden
  constexpr double kOfWrong =
      0.35;  // of one that is not: the fit has drawn it to the image's edges
  const double trials = static_cast<double>(samples) * step_px / kTogether_px;
  return -trials * (share * std::log10(kOfRight / kOfWrong) +
                    (1.0 - share) * std::log10((1.0 - kOfRight) / (1.0 - kOfWrong)));
}

std::vector<PosePoint> PoseCheck::matched_points(const MonoCandidate& candidate) const {
  std::vector<PosePoint> points;
  for (const Match& match : candidate.matches) {
    PosePoint point = models_[candidate.model].points[match.model];
    point.uv = image_[match.image].uv;
    point.sigma_px = image_[match.image].sigma_px;
    points.push_back(point);
  }
  return points;
}

void PoseCheck::judge_shape(MonoCandidate& candidate) const {
  constexpr double kStep_px = 6.0, kReach_px = 8.0, kCosine = 0.906, kEdgeSigma_px = 0.7;
  constexpr std::size_t kMostSamples = 300;
  const SearchModel& search = models_[candidate.model];
  std::vector<PoseEdge> along;
  std::vector<SeenEdge> held;
  if (!edges_.empty()) {
    for (const EdgeSample& sample :
         visible_edges(search, camera_, candidate.pose, kStep_px * options_.scale, kMostSamples)) {
      const EdgePoint* edge =
          edges_.nearest(sample.uv, sample.normal, kReach_px * options_.scale, kCosine);
      if (edge == nullptr) continue;
      const Eigen::Vector2d uv = edge->uv.cast<double>();
      along.push_back({sample.xyz, uv, sample.normal, kEdgeSigma_px});
      if (sample.line < search.model().edges.size()) held.push_back({sample, uv});
    }
    candidate.edges = judge_edges(search, camera_, candidate.pose, edges_, options_.scale);
  }
  candidate.shape_odds =
      stretched_rival(search, camera_, candidate.pose, matched_points(candidate), along).log10_odds;
  if (edges_.empty()) return;  // by points alone faces have no say
  std::vector<SeenCorner> corners;
  for (const Match& match : candidate.matches)
    corners.push_back({match.model, image_[match.image].uv, image_[match.image].sigma_px});
  candidate.face_odds =
      face_rival(search, camera_, candidate.pose, corners, held).value_or(candidate.shape_odds);
}

void PoseCheck::settle_on_edges(MonoCandidate& candidate) const {
  if (edges_.empty()) return;
  constexpr double kStep_px = 6.0;
  constexpr std::size_t kMostSamples = 600;
  constexpr std::array<double, 4> kReach_px{6.0, 4.0, 3.0, 2.0};
  constexpr double kCosine = 0.906;      // 25 degrees
  constexpr double kEdgeSigma_px = 1.0;  // samples stand close: their errors go together
  const SearchModel& search = models_[candidate.model];
  const std::vector<PosePoint> points = matched_points(candidate);
  std::vector<PoseEdge> along;
  RigidPose pose = candidate.pose;
  std::vector<EdgeSample> samples =
      visible_edges(search, camera_, pose, kStep_px * options_.scale, kMostSamples);
  const double before = edge_share(samples, edges_);
  RefineState state;
  bool refined = false;
  for (const double reach : kReach_px) {
    along.clear();
    for (const EdgeSample& sample : samples) {
      const EdgePoint* edge =
          edges_.nearest(sample.uv, sample.normal, reach * options_.scale, kCosine);
      if (edge != nullptr) {
        along.push_back({sample.xyz, edge->uv.cast<double>(), sample.normal, kEdgeSigma_px});
      }
    }
    RefineOptions options;
    options.huber = kHuber;
    options.max_steps = 4;
    if (!start_refinement(points, along, camera_, pose, options, state)) break;
    refine_steps(points, along, camera_, options, options.max_steps, state);
    if (!state.pose.t.allFinite()) break;
    pose = state.pose;
    refined = true;
    samples = visible_edges(search, camera_, pose, kStep_px * options_.scale, kMostSamples);
  }
  const double share = edge_share(samples, edges_);
  candidate.edge_share = std::max(share, before);
  if (refined && share >= before) {
    candidate.pose = pose;
    candidate.covariance = pose_covariance(state.equations);
    double sum = 0.0;
    for (Match& match : candidate.matches) {
      const SeenRay ray = seen_ray(search.points[match.model], pose);
      const double d = ray.ok ? (distort(camera_, ray.ray) - image_[match.image].uv).norm() : 1e3;
      match.distance_px = static_cast<float>(d);
      sum += d * d;
    }
    candidate.rms_px = std::sqrt(sum / static_cast<double>(candidate.matches.size()));
  }
  candidate.edge_odds = score_edges(samples.size(), kStep_px, candidate.edge_share);
}

}  // namespace landmarkdb
