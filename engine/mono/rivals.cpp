#include "engine/mono/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/mono/mirror_rival.hpp"
#include "engine/mono/point_pose.hpp"
#include "engine/mono/refine_pose.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kSettled = 12;   // candidates that are brought to rest
constexpr std::size_t kMirrored = 3;   // candidates that are held against mirror images
constexpr std::size_t kMostKept = 24;  // that are remembered as rivals
// log10 of false alarms: of more than this nothing is recognised, whatever else speaks for it.
constexpr double kWorthJudging = 4.0;
constexpr int kClimbs = 4;  // a grid of six is crossed in as many places, two at a time

void sort_by_rank(std::vector<MonoCandidate>& candidates, std::size_t most) {
  std::stable_sort(
      candidates.begin(), candidates.end(), [](const MonoCandidate& a, const MonoCandidate& b) {
        return a.rank() < b.rank();
      });
  if (candidates.size() > most)
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(most), candidates.end());
}

// Tries the poses that carry a model's lookalike onto this one.
void try_lookalikes(std::span<const SearchModel> models,
                    const MonoCandidate& from,
                    PoseCheck& check,
                    CandidatePool& pool) {
  const std::uint32_t model = from.model;
  const RigidPose pose = from.pose;  // the pool may move `from`
  for (const Eigen::Isometry3d& T : models[model].lookalikes) {
    const RigidPose moved{pose.R * T.linear(), pose.R * T.translation() + pose.t};
    const std::span<const Match> matches = check.look(model, moved);
    if (matches.empty()) continue;
    const std::vector<Match> start(matches.begin(), matches.end());
    std::optional<MonoCandidate> candidate = check.settle(model, moved, start);
    if (candidate) pool.add(std::move(*candidate));
  }
}

// The other tilt of a plane that explains the same points: the better becomes the pose, and both
// are known where the noise cannot tell them apart.
void settle_twins(std::span<const SearchModel> models,
                  const ImageView& image,
                  const Camera& camera,
                  MonoCandidate& candidate) {
  std::vector<PosePoint> points;
  double sigma_px = 0.0;
  for (const Match& match : candidate.matches) {
    PosePoint point = models[candidate.model].points[match.model];
    point.uv = image[match.image].uv;
    point.sigma_px = image[match.image].sigma_px;
    sigma_px += point.sigma_px / static_cast<double>(candidate.matches.size());
    points.push_back(point);
  }
  PointPoseOptions options;
  options.huber = 2.0;
  options.sigma_px = std::max(sigma_px, candidate.rms_px / std::sqrt(2.0));
  const PointPoses found = solve_points(points, camera, options);
  if (found.count == 0) return;
  const RefineOptions refine{.huber = 2.0};
  RefineState now;
  if (!start_refinement(points, {}, camera, candidate.pose, refine, now)) return;
  if (found.poses[0].cost < now.equations.cost * (1.0 - 1e-3) - 1e-3) {
    candidate.pose = found.poses[0].pose;
    candidate.covariance = found.poses[0].covariance;
    candidate.rms_px = found.poses[0].rms_px;
  }
  if (found.status != PoseStatus::kAmbiguous) return;
  candidate.ambiguous = true;
  // Whichever of the two the candidate is not.
  const bool first = (found.poses[0].pose.R - candidate.pose.R).norm() >
                     (found.poses[1].pose.R - candidate.pose.R).norm();
  candidate.twin = found.poses[first ? 0 : 1].pose;
  const double variance = options.sigma_px * options.sigma_px / (sigma_px * sigma_px);
  candidate.twin_odds = std::exp(
      -0.5 * std::min(100.0, std::abs(found.poses[1].cost - found.poses[0].cost) / variance));
}

// Which side of a flat model the camera is on: positive where the plane's normal, with its largest
// part positive, points to it; 0 for a model that is not flat.
double side_of_plane(const SearchModel& search, const RigidPose& pose) {
  if (!is_flat(search.model())) return 0.0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const PosePoint& point : search.points) {
    const Eigen::Vector3d w = point.xyz - search.center;
    spread += w * w.transpose();
  }
  Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  Eigen::Index largest = 0;
  normal.cwiseAbs().maxCoeff(&largest);
  if (normal[largest] < 0.0) normal = -normal;
  return normal.dot(-(pose.R.transpose() * pose.t) - search.center);
}

// A flat pattern that is its own mirror image looks the same from behind. It is then taken to lie
// as calibration targets do: x right, y down, z away from the camera. The other pose is no rival.
void prefer_front(std::span<const SearchModel> models, std::vector<MonoCandidate>& candidates) {
  constexpr double kSame = 1.0;  // log10 of the false alarms
  if (candidates.empty()) return;
  const std::uint32_t model = candidates.front().model;
  const double side = side_of_plane(models[model], candidates.front().pose);
  for (std::size_t i = 1; i < candidates.size() && side != 0.0; ++i) {
    if (candidates[i].rank() > candidates.front().rank() + kSame) return;
    if (candidates[i].model != model ||
        side_of_plane(models[model], candidates[i].pose) * side >= 0.0) {
      continue;
    }
    if (side > 0.0) candidates.front() = candidates[i];
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

}  // namespace

void settle_rivals(std::span<const SearchModel> models,
                   const ImageView& image,
                   const Camera& camera,
                   PoseCheck& check,
                   PoseCheck& mirrors,
                   CandidatePool& pool,
                   const RunContext& run) {
  std::vector<MonoCandidate>& candidates = pool.candidates();
  sort_by_rank(candidates, kMostKept);
  for (int climb = 0; climb < kClimbs && !candidates.empty(); ++climb) {
    const double best = candidates.front().log10_nfa;
    const std::size_t count = climb == 0 ? std::min<std::size_t>(3, candidates.size()) : 1;
    const std::vector<MonoCandidate> from(candidates.begin(),
                                          candidates.begin() + static_cast<std::ptrdiff_t>(count));
    for (const MonoCandidate& candidate : from) {
      run.check("refine");
      try_lookalikes(models, candidate, check, pool);
    }
    sort_by_rank(candidates, kMostKept);
    if (climb > 0 && !(candidates.front().log10_nfa < best)) break;
  }
  for (std::size_t i = 0; i < std::min(kSettled, candidates.size()); ++i) {
    run.check("refine");
    settle_twins(models, image, camera, candidates[i]);
    check.settle_on_edges(candidates[i]);
    if (candidates[i].rank() < kWorthJudging) check.judge_shape(candidates[i]);
  }
  sort_by_rank(candidates, kMostKept);
  prefer_front(models, candidates);
  for (std::size_t i = 0; i < std::min(kMirrored, candidates.size()); ++i) {
    const SearchModel& model = models[candidates[i].model];
    if (is_flat(model.model())) continue;  // it is its own mirror image, and has its twin above
    run.check("refine");
    candidates[i].mirror_margin = mirror_margin(model, candidates[i], mirrors);
  }
}

}  // namespace landmarkdb
