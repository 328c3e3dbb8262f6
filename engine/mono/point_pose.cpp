#include "engine/mono/point_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/mono/refine_pose.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kOnStack = 64;  // points that need no memory from the heap
constexpr int kFirstSteps = 6;        // of either branch of a plane, before the better is finished
// Two poses of a plane are both told where the other's rms is below this many times the best's, or
// its cost within the square of three sigmas of it.
constexpr double kRmsRatio = 2.0;
constexpr double kSigmas2 = 9.0;
// Few or nearly coplanar points have a second minimum. A cost this many of its standard deviations
// above what the noise makes (chi squared) sends the search to the other starts.
constexpr double kTooCostly = 3.0;
constexpr double kSamePose = 1e-6;  // rad, and of the distance: both branches ended in one minimum

RefineOptions refine_options(const PointPoseOptions& options) {
  RefineOptions refine;
  if (options.huber > 0.0) refine.huber = options.huber;
  return refine;
}

// Sum of the squared distances in pixels.
double squared_px(std::span<const PosePoint> points, const Camera& camera, const RigidPose& pose) {
  double sum = 0.0;
  for (const PosePoint& point : points) {
    const SeenRay seen = seen_ray(point, pose);
    if (!seen.ok) return std::numeric_limits<double>::infinity();
    sum += (distort(camera, seen.ray) - point.uv).squaredNorm();
  }
  return sum;
}

PointPose finished(std::span<const PosePoint> points,
                   const Camera& camera,
                   const RefineState& state) {
  PointPose result;
  result.pose = state.pose;
  result.cost = state.equations.cost;
  result.rms_px =
      std::sqrt(squared_px(points, camera, state.pose) / static_cast<double>(points.size()));
  result.covariance = pose_covariance(state.equations);
  return result;
}

bool costs_too_much(std::span<const PosePoint> points,
                    const Camera& camera,
                    const RefineState& state,
                    const PointPoseOptions& options) {
  const double freedom = std::max(1.0, 2.0 * static_cast<double>(points.size()) - 6.0);
  const double squared = squared_px(points, camera, state.pose);
  return squared >
         options.sigma_px * options.sigma_px * (freedom + kTooCostly * std::sqrt(2.0 * freedom));
}

bool same_pose(const RigidPose& a, const RigidPose& b) {
  return (a.R - b.R).cwiseAbs().maxCoeff() < kSamePose &&
         (a.t - b.t).norm() < kSamePose * a.t.norm();
}

bool finite(const PosePoint& point) {
  return point.xyz.allFinite() && point.uv.allFinite() && point.sigma_px > 0.0 &&
         std::isfinite(point.sigma_px) && std::isfinite(point.radius_m) &&
         point.normal.allFinite() && point.longer.allFinite();
}

}  // namespace

PointPoses solve_points(std::span<const PosePoint> points,
                        const Camera& camera,
                        const PointPoseOptions& options) {
  PointPoses result;
  result.status = PoseStatus::kTooFewPoints;
  if (points.size() < 4) return result;
  std::array<Eigen::Vector3d, kOnStack> xyz_near;
  std::array<Eigen::Vector2d, kOnStack> rays_near;
  std::vector<Eigen::Vector3d> xyz_far;
  std::vector<Eigen::Vector2d> rays_far;
  std::span<Eigen::Vector3d> xyz(xyz_near.data(), std::min(points.size(), kOnStack));
  std::span<Eigen::Vector2d> rays(rays_near.data(), std::min(points.size(), kOnStack));
  if (points.size() > kOnStack) {
    xyz_far.resize(points.size());
    rays_far.resize(points.size());
    xyz = xyz_far;
    rays = rays_far;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.status = PoseStatus::kNotFinite;
    if (!finite(points[i])) return result;
    const std::optional<Eigen::Vector2d> ray = undistort(camera, points[i].uv);
    result.status = PoseStatus::kOutsideLensModel;
    if (!ray) return result;
    xyz[i] = points[i].xyz;
    rays[i] = *ray;
  }
  const StartPoses start = start_poses(xyz, rays);
  result.status = start.status;
  if (start.status != PoseStatus::kOk) return result;

  const RefineOptions refine = refine_options(options);
  std::array<RefineState, 2> states;
  int count = 0;
  for (int b = 0; b < start.count; ++b) {
    RefineState& state = states[static_cast<std::size_t>(count)];
    const RigidPose& pose = start.poses[static_cast<std::size_t>(b)];
    if (start_refinement(points, {}, camera, pose, refine, state)) ++count;
  }
  result.status = PoseStatus::kBehindCamera;
  if (count == 0) return result;
  if (count == 2) {
    for (RefineState& state : states) {
      refine_steps(points, {}, camera, refine, kFirstSteps, state);
    }
    if (states[1].equations.cost < states[0].equations.cost) std::swap(states[0], states[1]);
  }
  refine_steps(points, {}, camera, refine, refine.max_steps, states[0]);
  if (!start.planar && costs_too_much(points, camera, states[0], options)) {
    const StartPoses flat = start_poses(xyz, rays, true);
    for (int b = 0; b < flat.count; ++b) {
      const RigidPose& pose = flat.poses[static_cast<std::size_t>(b)];
      if (!start_refinement(points, {}, camera, pose, refine, states[1])) continue;
      refine_steps(points, {}, camera, refine, refine.max_steps, states[1]);
      if (states[1].equations.cost < states[0].equations.cost) states[0] = states[1];
    }
  }
  result.status = PoseStatus::kOk;
  result.count = 1;
  result.poses[0] = finished(points, camera, states[0]);
  if (count == 2 && !same_pose(states[0].pose, states[1].pose)) {
    // sigma_px of the points is a unit here; that of the options says what the noise is.
    const double best = result.poses[0].rms_px;
    const double n = static_cast<double>(points.size());
    const double other2 = squared_px(points, camera, states[1].pose);
    const bool by_ratio = other2 < kRmsRatio * kRmsRatio * best * best * n;
    const bool by_noise = other2 - best * best * n < kSigmas2 * options.sigma_px * options.sigma_px;
    if (by_ratio || by_noise) {
      refine_steps(points, {}, camera, refine, refine.max_steps, states[1]);
      if (!same_pose(states[0].pose, states[1].pose)) {
        result.poses[1] = finished(points, camera, states[1]);
        result.count = 2;
        result.status = PoseStatus::kAmbiguous;
      }
    }
  }
  return result;
}

PointPoses refine_points(std::span<const PosePoint> points,
                         const Camera& camera,
                         const RigidPose& start,
                         const PointPoseOptions& options) {
  PointPoses result;
  for (const PosePoint& point : points) {
    if (!finite(point)) return result;
  }
  result.status = PoseStatus::kTooFewPoints;
  if (points.size() < 3) return result;
  const RefineOptions refine = refine_options(options);
  RefineState state;
  result.status = PoseStatus::kBehindCamera;
  if (!start_refinement(points, {}, camera, start, refine, state)) return result;
  refine_steps(points, {}, camera, refine, refine.max_steps, state);
  result.status = PoseStatus::kOk;
  result.count = 1;
  result.poses[0] = finished(points, camera, state);
  return result;
}

}  // namespace landmarkdb
