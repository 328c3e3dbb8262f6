#include "engine/registration/estimate_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {

namespace {

struct Pairs {
  std::vector<Eigen::Vector3d> target;
  std::vector<Eigen::Vector3d> source;
};

Pairs gather(std::span<const Eigen::Vector3f> target,
             std::span<const Eigen::Vector3f> source,
             std::span<const Correspondence> correspondences) {
  Pairs pairs;
  for (const Correspondence& pair : correspondences) {
    if (pair.target >= target.size() || pair.query >= source.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "a correspondence names keypoints " + std::to_string(pair.query) + " and " +
                      std::to_string(pair.target) + ", but there are " +
                      std::to_string(source.size()) + " and " + std::to_string(target.size()));
    }
    pairs.target.push_back(target[pair.target].cast<double>());
    pairs.source.push_back(source[pair.query].cast<double>());
  }
  return pairs;
}

std::vector<std::uint32_t> inliers_of(const Pairs& pairs,
                                      const Similarity& pose,
                                      double max_residual_m) {
  std::vector<std::uint32_t> inliers;
  for (std::size_t i = 0; i < pairs.source.size(); ++i) {
    const Eigen::Vector3d there = pose.scale * pose.R * pairs.source[i] + pose.t;
    if ((there - pairs.target[i]).squaredNorm() <= max_residual_m * max_residual_m) {
      inliers.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return inliers;
}

std::optional<Similarity> fit(const Pairs& pairs,
                              std::span<const std::uint32_t> chosen,
                              bool scale) {
  std::vector<Eigen::Vector3d> target;
  std::vector<Eigen::Vector3d> source;
  for (const std::uint32_t i : chosen) {
    target.push_back(pairs.target[i]);
    source.push_back(pairs.source[i]);
  }
  return estimate_similarity(target, source, scale);
}

// Triangles of one shape have edges in one ratio; with the scale fixed that ratio is 1.
bool alike(const Pairs& pairs,
           const std::array<std::uint32_t, 3>& triple,
           const PoseOptions& options) {
  double low = options.estimate_scale ? 1e300 : 1.0;
  double high = options.estimate_scale ? 0.0 : 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = triple[k];
    const std::uint32_t b = triple[(k + 1) % 3];
    const double target_edge = (pairs.target[a] - pairs.target[b]).norm();
    const double source_edge = (pairs.source[a] - pairs.source[b]).norm();
    // Shorter than twice the tolerance says nothing about a rotation.
    if (source_edge < 2.0 * options.max_residual_m || target_edge <= 0.0) return false;
    low = std::min(low, target_edge / source_edge);
    high = std::max(high, target_edge / source_edge);
  }
  return low / high >= options.edge_tolerance;
}

// Draws needed until a sample of three inliers has come up with the wanted confidence.
double draws_needed(double inlier_share, double confidence) {
  const double hit = inlier_share * inlier_share * inlier_share;
  return hit >= 1.0 ? 1.0 : std::log(1.0 - confidence) / std::log1p(-hit);
}

}  // namespace

std::optional<PoseEstimate> estimate_pose(std::span<const Eigen::Vector3f> target,
                                          std::span<const Eigen::Vector3f> source,
                                          std::span<const Correspondence> correspondences,
                                          const PoseOptions& options) {
  const Pairs pairs = gather(target, source, correspondences);
  const std::size_t n = pairs.source.size();
  if (n < std::max<std::size_t>(3, options.min_inliers)) return std::nullopt;
  Random random(options.seed);
  PoseEstimate best;
  double needed = options.max_iterations;
  for (std::uint32_t draw = 0; draw < options.max_iterations && draw < needed; ++draw) {
    std::array<std::uint32_t, 3> triple{};
    for (std::uint32_t& index : triple) index = static_cast<std::uint32_t>(random.below(n));
    if (triple[0] == triple[1] || triple[1] == triple[2] || triple[0] == triple[2]) continue;
    if (!alike(pairs, triple, options)) continue;
    const std::optional<Similarity> pose = fit(pairs, triple, options.estimate_scale);
    if (!pose) continue;
    std::vector<std::uint32_t> inliers = inliers_of(pairs, *pose, options.max_residual_m);
    if (inliers.size() <= best.inliers.size()) continue;
    best = {*pose, std::move(inliers)};
    needed = draws_needed(static_cast<double>(best.inliers.size()) / static_cast<double>(n),
                          options.confidence);
  }
  for (int round = 0; round < 5 && best.inliers.size() >= 3; ++round) {
    const std::optional<Similarity> refit = fit(pairs, best.inliers, options.estimate_scale);
    if (!refit) break;
    std::vector<std::uint32_t> inliers = inliers_of(pairs, *refit, options.max_residual_m);
    if (inliers.size() < best.inliers.size()) break;
    const bool same = inliers == best.inliers;
    best = {*refit, std::move(inliers)};
    if (same) break;
  }
  if (best.inliers.size() < options.min_inliers) return std::nullopt;
  return best;
}

}  // namespace landmarkdb
