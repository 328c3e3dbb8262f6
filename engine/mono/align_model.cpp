#include "engine/mono/align_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/mono/refine_pose.hpp"

namespace landmarkdb {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kTukey = 4.685;  // 95 % efficient for normal errors (Huber 1981)
constexpr double kMad = 1.4826;   // median of absolute values -> sigma

// What one round weighs: residuals in sigmas, and the candidate each sample was drawn to.
struct Residuals {
  std::vector<double> edge;  // sigmas, infinite without a candidate
  std::vector<const EdgeCandidate*> drawn;
  std::vector<double> point;  // sigmas
};

Residuals residuals_at(std::span<const TrackSample> samples,
                       const EdgeCandidates& candidates,
                       std::span<const PosePoint> points,
                       const Camera& camera,
                       const RigidPose& pose,
                       const AlignOptions& options) {
  Residuals result;
  result.edge.assign(samples.size(), kFar);
  result.drawn.assign(samples.size(), nullptr);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::optional<Eigen::Vector2d> uv = project(camera, pose * samples[i].xyz);
    if (!uv) continue;
    const double at = (*uv - samples[i].uv).dot(samples[i].normal);
    double best_px = kFar;
    for (const EdgeCandidate& candidate : candidates.of(i)) {
      const double off_px = std::abs(at - static_cast<double>(candidate.offset_px));
      const double score_px = std::hypot(off_px, static_cast<double>(candidate.unlike_px));
      if (off_px >= options.reach_px || score_px >= best_px) continue;
      best_px = score_px;
      result.drawn[i] = &candidate;
      result.edge[i] = off_px / options.edge_sigma_px;
    }
  }
  for (const PosePoint& point : points) {
    const SeenRay seen = seen_ray(point, pose);
    if (!seen.ok || !inside_lens_model(camera, seen.ray)) {
      result.point.push_back(kFar);
      continue;
    }
    result.point.push_back((distort(camera, seen.ray) - point.uv).norm() / point.sigma_px);
  }
  return result;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double tukey_weight(double residual, double bound) {
  if (!(residual < bound)) return 0.0;
  const double share = residual / bound;
  return (1.0 - share * share) * (1.0 - share * share);
}

// The bound beyond which a residual says nothing in a round, in sigmas: from the spread of all, and
// at first no less than the reach, halved every round, or what has moved would count as an outlier
// of what has not.
double tukey_bound(const Residuals& residuals, int round, const AlignOptions& options) {
  std::vector<double> all;
  for (const double r : residuals.edge) {
    if (r < kFar) all.push_back(r);
  }
  for (const double r : residuals.point) {
    if (r < kFar) all.push_back(r);
  }
  constexpr double kLeast = 2.0;  // sigmas: so much is noise even where most residuals are smaller
  const double opening = std::ldexp(options.reach_px / options.edge_sigma_px, -round);
  return std::max({kTukey * kMad * median(std::move(all)), kLeast, opening});
}

struct Weighted {
  std::vector<PoseEdge> edges{};
  std::vector<PosePoint> points{};
  double squares_px2 = 0.0;
};

Weighted weigh(std::span<const TrackSample> samples,
               std::span<const PosePoint> points,
               const Residuals& residuals,
               int round,
               const AlignOptions& options) {
  const double bound = tukey_bound(residuals, round, options);
  constexpr double kLeastWeight = 1e-3;  // below, a sigma would grow out of bounds
  Weighted result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double weight = tukey_weight(residuals.edge[i], bound);
    if (weight < kLeastWeight) continue;
    const Eigen::Vector2d uv =
        samples[i].uv + static_cast<double>(residuals.drawn[i]->offset_px) * samples[i].normal;
    result.edges.push_back({.xyz = samples[i].xyz,
                            .uv = uv,
                            .normal = samples[i].normal,
                            .sigma_px = options.edge_sigma_px / std::sqrt(weight) *
                                        (samples[i].crowded ? options.crowded_sigmas : 1.0)});
    result.squares_px2 += std::pow(residuals.edge[i] * options.edge_sigma_px, 2);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = tukey_weight(residuals.point[i], bound);
    if (weight < kLeastWeight) continue;
    PosePoint point = points[i];
    result.squares_px2 += std::pow(residuals.point[i] * point.sigma_px, 2);
    point.sigma_px /= std::sqrt(weight);
    result.points.push_back(point);
  }
  return result;
}

}  // namespace

Alignment align_model(std::span<const TrackSample> samples,
                      const EdgeCandidates& candidates,
                      std::span<const PosePoint> points,
                      const Camera& camera,
                      const RigidPose& start,
                      const AlignOptions& options) {
  Alignment result;
  result.pose = start;
  RefineOptions refine;  // no Huber: the weights are Tukey's
  constexpr int kSteps = 3;
  Residuals residuals = residuals_at(samples, candidates, points, camera, start, options);
  for (int round = 0; round < options.rounds; ++round) {
    const Weighted weighted = weigh(samples, points, residuals, round, options);
    RefineState state;
    if (weighted.edges.size() + 2 * weighted.points.size() < 6 ||
        !start_refinement(weighted.points, weighted.edges, camera, result.pose, refine, state)) {
      result.pose = start;
      result.fixed = false;
      break;
    }
    refine_steps(weighted.points, weighted.edges, camera, refine, kSteps, state);
    const double moved_m = (state.pose.t - result.pose.t).norm();
    const double turned = (state.pose.R - result.pose.R).norm();
    result.pose = state.pose;
    result.covariance = pose_covariance(state.equations);
    result.fixed = result.covariance.diagonal().minCoeff() > 0.0 && state.pose.t.allFinite();
    const std::size_t kept = weighted.edges.size() + weighted.points.size();
    result.rms_px = std::sqrt(weighted.squares_px2 / static_cast<double>(kept));
    residuals = residuals_at(samples, candidates, points, camera, result.pose, options);
    constexpr double kStill = 1e-6;  // m and rad: a thousandth of a pixel at arm's length
    const bool open = options.reach_px > std::ldexp(options.edge_sigma_px, round);
    if (!open && moved_m < kStill && turned < kStill) break;
  }
  for (const double r : residuals.edge) result.edge_off_px.push_back(r * options.edge_sigma_px);
  return result;
}

}  // namespace landmarkdb
