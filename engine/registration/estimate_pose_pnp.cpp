#include "engine/registration/estimate_pose_pnp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/registration/solve_p3p.hpp"

namespace landmarkdb {

namespace {

struct Sights {
  std::vector<Eigen::Vector3d> bearings;  // unit, from the viewpoint, source axes
  std::vector<Eigen::Vector3d> points;    // target frame
};

Sights gather(std::span<const Eigen::Vector3f> target,
              std::span<const Eigen::Vector3f> source,
              const Eigen::Vector3d& viewpoint,
              std::span<const Correspondence> correspondences) {
  Sights sights;
  for (const Correspondence& pair : correspondences) {
    if (pair.target >= target.size() || pair.query >= source.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "a correspondence names keypoints " + std::to_string(pair.query) + " and " +
                      std::to_string(pair.target) + ", but there are " +
                      std::to_string(source.size()) + " and " + std::to_string(target.size()));
    }
    // A keypoint at the eye, or one that is not finite, is seen nowhere: zero agrees with nothing.
    const Eigen::Vector3d ray = source[pair.query].cast<double>() - viewpoint;
    const bool seen = ray.allFinite() && ray.norm() > 0.0;
    sights.bearings.push_back(seen ? Eigen::Vector3d(ray.normalized()) : Eigen::Vector3d::Zero());
    sights.points.push_back(target[pair.target].cast<double>());
  }
  return sights;
}

// What is left of the point beside its line of sight; nothing for a point behind the eye.
std::optional<Eigen::Vector3d> beside(const Sights& sights,
                                      std::size_t i,
                                      const Eigen::Isometry3d& T_eye_target) {
  const Eigen::Vector3d p = T_eye_target * sights.points[i];
  const double along = p.dot(sights.bearings[i]);
  if (!(along > 0.0)) return std::nullopt;
  return p - along * sights.bearings[i];
}

std::vector<std::uint32_t> inliers_of(const Sights& sights,
                                      const Eigen::Isometry3d& T_eye_target,
                                      double max_residual_m) {
  std::vector<std::uint32_t> inliers;
  for (std::size_t i = 0; i < sights.points.size(); ++i) {
    const auto off = beside(sights, i, T_eye_target);
    if (off && off->squaredNorm() <= max_residual_m * max_residual_m) {
      inliers.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return inliers;
}

// Gauss-Newton on the angles between sights and points, in radians: residual (I - b b^T) p / |p|.
Eigen::Isometry3d refine(const Sights& sights,
                         std::span<const std::uint32_t> inliers,
                         Eigen::Isometry3d T_eye_target) {
  constexpr int kRounds = 10;
  constexpr double kSettled = 1e-9;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    for (const std::uint32_t i : inliers) {
      const Eigen::Vector3d p = T_eye_target * sights.points[i];
      const double range = p.norm();
      if (!(range > 0.0)) continue;
      const Eigen::Vector3d& b = sights.bearings[i];
      const Eigen::Matrix3d off = (Eigen::Matrix3d::Identity() - b * b.transpose()) / range;
      Eigen::Matrix<double, 3, 6> J;  // of a small move: p + t + w x p
      J.leftCols<3>() = off;
      Eigen::Matrix3d cross;
      cross << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
      J.rightCols<3>() = -off * cross;
      A += J.transpose() * J;
      g += J.transpose() * (off * p);
    }
    const Eigen::Matrix<double, 6, 1> step = A.ldlt().solve(-g);
    if (!step.allFinite()) break;
    Eigen::Isometry3d move = Eigen::Isometry3d::Identity();
    move.linear() = rotation_from_vector(step.tail<3>());
    move.translation() = step.head<3>();
    T_eye_target = move * T_eye_target;
    if (step.norm() < kSettled) break;
  }
  T_eye_target.linear() = nearest_rotation(T_eye_target.linear());
  return T_eye_target;
}

double draws_needed(double inlier_share, double confidence) {
  const double hit = inlier_share * inlier_share * inlier_share;
  return hit >= 1.0 ? 1.0 : std::log(1.0 - confidence) / std::log1p(-hit);
}

struct Best {
  Eigen::Isometry3d T_eye_target = Eigen::Isometry3d::Identity();
  std::vector<std::uint32_t> inliers;
};

// The pose of a sample that most agree with.
Best draw_poses(const Sights& sights, const PoseOptions& options) {
  const std::size_t n = sights.points.size();
  Random random(options.seed);
  Best best;
  double needed = options.max_iterations;
  for (std::uint32_t draw = 0; draw < options.max_iterations && draw < needed; ++draw) {
    const std::array<std::size_t, 3> triple = {random.below(n), random.below(n), random.below(n)};
    if (triple[0] == triple[1] || triple[1] == triple[2] || triple[0] == triple[2]) continue;
    std::array<Eigen::Vector3d, 3> bearings;
    std::array<Eigen::Vector3d, 3> points;
    for (std::size_t k = 0; k < 3; ++k) {
      bearings[k] = sights.bearings[triple[k]];
      points[k] = sights.points[triple[k]];
    }
    for (const Eigen::Isometry3d& T : solve_p3p(bearings, points)) {
      std::vector<std::uint32_t> inliers = inliers_of(sights, T, options.max_residual_m);
      if (inliers.size() <= best.inliers.size()) continue;
      best = {T, std::move(inliers)};
      needed = draws_needed(static_cast<double>(best.inliers.size()) / static_cast<double>(n),
                            options.confidence);
    }
  }
  return best;
}

}  // namespace

std::optional<PoseEstimate> estimate_pose_pnp(std::span<const Eigen::Vector3f> target,
                                              std::span<const Eigen::Vector3f> source,
                                              const Eigen::Vector3d& viewpoint,
                                              std::span<const Correspondence> correspondences,
                                              const PoseOptions& options) {
  const Sights sights = gather(target, source, viewpoint, correspondences);
  // Three are explained by up to four poses: a fourth must choose.
  const std::size_t fewest = std::max<std::size_t>(4, options.min_inliers);
  if (sights.points.size() < fewest) return std::nullopt;
  Best best = draw_poses(sights, options);
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds && best.inliers.size() >= fewest; ++round) {
    const Eigen::Isometry3d refined = refine(sights, best.inliers, best.T_eye_target);
    std::vector<std::uint32_t> inliers = inliers_of(sights, refined, options.max_residual_m);
    if (inliers.size() < best.inliers.size()) break;
    const bool same = inliers == best.inliers;
    best = {refined, std::move(inliers)};
    if (same) break;
  }
  if (best.inliers.size() < fewest) return std::nullopt;
  // p_target = T_eye_target^-1 (p_source - viewpoint)
  const Eigen::Isometry3d T_target_eye = best.T_eye_target.inverse();
  PoseEstimate estimate;
  estimate.T_target_source.R = T_target_eye.linear();
  estimate.T_target_source.t = T_target_eye.translation() - T_target_eye.linear() * viewpoint;
  estimate.inliers = std::move(best.inliers);
  return estimate;
}

}  // namespace landmarkdb
