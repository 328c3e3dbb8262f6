#include "engine/mono/pose_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/mono/face_rival.hpp"
#include "engine/mono/point_pose.hpp"
#include "engine/mono/refine_pose.hpp"
#include "engine/mono/stretched_rival.hpp"

namespace landmarkdb {
namespace {

// Tolerances in pixels of a 640 pixels wide image: the quick look, then after each refinement.
constexpr double kLook_px = 8.0;
constexpr std::array<double, 3> kRounds_px{5.0, 3.5, 3.5};
constexpr double kFinal_px = 3.5;
constexpr double kUnlike = 0.015;  // of the diameter: how far a thing's corners are off its model's
constexpr std::size_t kLeastHits = 5;
constexpr double kLeastShare = 0.35;        // of the visible points
constexpr double kHuber = 2.0;              // sigmas
constexpr double kChanceOfLink = 0.25;      // at most, of two chance matches: see score
constexpr std::size_t kSearched = 3;        // links that the search itself has asked for
constexpr double kLeastChanceOfArm = 0.25;  // edges of real scenes share their directions
constexpr double kDirection_rad = 12.0 * std::numbers::pi / 180.0;

constexpr std::size_t kGrowFrom = 7;  // points that agree before a pose is refined to find more

// Matches that a pose of so many visible points has to show at first sight.
std::size_t hits_needed(std::size_t visible) {
  return std::max(kLeastHits,
                  static_cast<std::size_t>(std::ceil(kLeastShare * static_cast<double>(visible))));
}

Eigen::Vector2d ideal(const ImageView& image, const Eigen::Vector3d& X) {
  return image.focal_px() * X.head<2>() / X.z();
}

double turned_apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
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

double log10_binomial_tail(std::size_t trials, std::size_t hits, double p) {
  if (hits == 0) return 0.0;
  if (hits > trials || !(p > 0.0)) return hits > trials ? -300.0 : -300.0;
  if (p >= 1.0) return 0.0;
  // Terms from `hits` on; each is the last times (n - k) / (k + 1) * p / (1 - p).
  const double n = static_cast<double>(trials), k0 = static_cast<double>(hits);
  const double log_first = std::lgamma(n + 1.0) - std::lgamma(k0 + 1.0) -
                           std::lgamma(n - k0 + 1.0) + k0 * std::log(p) + (n - k0) * std::log1p(-p);
  double sum = 1.0, term = 1.0;
  for (double k = k0; k < n; k += 1.0) {
    term *= (n - k) / (k + 1.0) * p / (1.0 - p);
    sum += term;
  }
  return std::min(0.0, (log_first + std::log(sum)) / std::numbers::ln10);
}

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
      xy = ideal(image_, X);
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
  candidate.log10_nfa = score(candidate, seen, reach_px(model, candidate.pose, kFinal_px, unlike));
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

// Points: of those visible, four fix the pose and the others meet a feature by chance with the
// probability that a disc of the tolerance holds one of their type. Links: an edge between two
// matched points has its link in the image, which the quads of the search ask for twice.
// Directions: an image vertex' edges lie along the model's.
double PoseCheck::score(const MonoCandidate& candidate,
                        std::span<const std::uint16_t> seen,
                        double reach) const {
  const SearchModel& search = models_[candidate.model];
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  std::array<double, kFeatureTypes> of_type{};
  for (const std::uint16_t id : seen) {
    const Eigen::Vector3d X = candidate.pose * search.points[id].xyz;
    if (!(X.z() > 0.0)) continue;
    low = low.cwiseMin(ideal(image_, X));
    high = high.cwiseMax(ideal(image_, X));
    of_type[static_cast<std::size_t>(search.model().points[id].type)] += 1.0;
  }
  low.array() -= 2.0 * reach;
  high.array() += 2.0 * reach;
  std::array<double, kFeatureTypes> in_box{};
  for (const ImageView::Point& point : image_.points()) {
    if ((point.xy.array() >= low.array()).all() && (point.xy.array() <= high.array()).all()) {
      in_box[point.type] += 1.0;
    }
  }
  const double disc = std::numbers::pi * reach * reach / (high - low).prod();
  double p = 0.0;
  for (std::size_t type = 0; type < kFeatureTypes; ++type) p += of_type[type] * in_box[type];
  // The nearer the hits, the less likely by chance: the best of three radii counts (Moisan and
  // Stival 2004 take the best of all), where the features are placed well enough for the smallest
  // one.
  const double of_image = kFinal_px * options_.scale / reach;
  const std::array<double, 3> radii{1.0, of_image, 0.5 * of_image};
  double sigma_px = 0.0;
  for (const Match& match : candidate.matches) {
    sigma_px += image_[match.image].sigma_px / static_cast<double>(candidate.matches.size());
  }
  const std::size_t trials = seen.size() - std::min<std::size_t>(4, seen.size());
  double tail = 0.0, asked = 0.0, last = 2.0;
  for (const double radius : radii) {
    if (!(radius < last)) continue;  // the model is taken to be exact
    last = radius;
    if (radius < 1.0 && 3.0 * sigma_px > radius * reach) continue;
    const std::size_t hits = static_cast<std::size_t>(
        std::count_if(candidate.matches.begin(), candidate.matches.end(), [&](const Match& m) {
          return radius == 1.0 || double{m.distance_px} <= radius * reach;
        }));
    if (radius < 1.0 && hits < kLeastHits) continue;
    const double chance =
        1.0 - std::exp(-radius * radius * disc * p / static_cast<double>(seen.size()));
    asked += 1.0;
    tail = std::min(
        tail,
        log10_binomial_tail(trials, std::max(hits, kLeastHits - 1) - (kLeastHits - 1), chance));
  }
  double log10_nfa = options_.log10_tests + std::log10(asked) + tail;

  std::size_t edges = 0, linked = 0, arms = 0, fitting = 0;
  double chance_of_arm = 0.0;
  std::vector<int> image_of(search.points.size(), -1);
  for (const Match& match : candidate.matches) image_of[match.model] = match.image;
  for (const Match& match : candidate.matches) {
    const ImageView::Point& at = image_[match.image];
    const Eigen::Vector3d here = candidate.pose * search.points[match.model].xyz;
    for (const std::uint32_t other : search.neighbours[match.model]) {
      const int image = image_of[other];
      const bool joined = image >= 0 && image_.linked(match.image, static_cast<std::size_t>(image));
      if (image >= 0 && other > match.model) {
        ++edges;
        linked += joined ? 1 : 0;
      }
      if (joined) continue;  // a link lies along the edge: its direction says nothing new
      if (at.directions.empty()) continue;
      const Eigen::Vector3d there = candidate.pose * search.points[other].xyz;
      if (!(there.z() > 0.0)) continue;
      const Eigen::Vector2d d = ideal(image_, there) - ideal(image_, here);
      const double direction = std::atan2(d.y(), d.x());
      ++arms;
      chance_of_arm +=
          std::clamp(static_cast<double>(at.directions.size()) * kDirection_rad / std::numbers::pi,
                     kLeastChanceOfArm,
                     0.9);
      fitting += std::any_of(at.directions.begin(),
                             at.directions.end(),
                             [&](double seen_direction) {
                               return turned_apart(seen_direction, direction) < kDirection_rad;
                             })
                     ? 1
                     : 0;
    }
  }
  if (image_.link_count() > 0 && edges > kSearched) {
    // A point is linked to as many others as on the mean, out of the eight around it.
    const double degree =
        2.0 * static_cast<double>(image_.link_count()) / static_cast<double>(image_.size());
    const double q = std::clamp(degree / 8.0, 0.02, kChanceOfLink);
    log10_nfa +=
        log10_binomial_tail(edges - kSearched, linked > kSearched ? linked - kSearched : 0, q);
  }
  if (arms > kSearched) {
    log10_nfa += log10_binomial_tail(arms - kSearched,
                                     fitting > kSearched ? fitting - kSearched : 0,
                                     chance_of_arm / static_cast<double>(arms));
  }
  return log10_nfa;
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
  const double before = edge_share(
      visible_edges(search, camera_, candidate.pose, kStep_px * options_.scale, kMostSamples),
      edges_);
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
