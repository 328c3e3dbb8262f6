#include "bench/micro/pose_problems.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {
namespace {

constexpr double kWrong_deg = 15.0;

PoseProblem draw(Random& random, const Camera& camera, const PoseSet& set) {
  for (;;) {
    PoseProblem problem;
    const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
    problem.truth.R = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
    problem.truth.t = {
        random.uniform(-0.2, 0.2), random.uniform(-0.15, 0.15), random.uniform(0.8, 1.2)};
    // A plane that is seen edge-on shows no points.
    constexpr double kLeastCosine = 0.2;
    const Eigen::Vector3d sight = problem.truth.t.normalized();
    bool usable = !set.planar || std::abs(sight.dot(problem.truth.R.col(2))) > kLeastCosine;
    for (std::size_t i = 0; i < set.points; ++i) {
      PosePoint point;
      point.xyz = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
      if (set.planar) point.xyz.z() = 0.0;
      if (set.planar && set.points == 4) {
        point.xyz = {i % 2 == 0 ? -0.1 : 0.1, i < 2 ? -0.1 : 0.1, 0.0};
      }
      const auto uv = project(camera, problem.truth * point.xyz);
      usable = usable && uv;
      if (uv) point.uv = *uv + set.noise_px * Eigen::Vector2d(random.normal(), random.normal());
      problem.points.push_back(point);
    }
    if (usable) return problem;
  }
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double turn_deg(const RigidPose& pose, const RigidPose& truth) {
  return rotation_angle_rad(pose.R.transpose() * truth.R) * 180.0 / std::numbers::pi;
}

}  // namespace

Camera pose_camera() {
  Camera made;
  made.width = 640;
  made.height = 480;
  made.fx = made.fy = 600.0;
  made.cx = 320.0;
  made.cy = 240.0;
  return made;
}

std::vector<PoseProblem> draw_problems(const PoseSet& set, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const Camera camera = pose_camera();
  std::vector<PoseProblem> problems;
  for (std::size_t i = 0; i < count; ++i) problems.push_back(draw(random, camera, set));
  return problems;
}

PoseErrors errors_of(const std::vector<PoseProblem>& problems,
                     const std::vector<FoundPoses>& found) {
  constexpr double kNone_deg = 180.0, kNone_mm = 1e6;
  std::vector<double> turns, shifts;
  double wrong = 0.0, unsaid = 0.0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const FoundPoses& poses = found[i];
    const RigidPose& truth = problems[i].truth;
    turns.push_back(poses.empty() ? kNone_deg : turn_deg(poses.front(), truth));
    shifts.push_back(poses.empty() ? kNone_mm : (poses.front().t - truth.t).norm() * 1e3);
    if (turns.back() <= kWrong_deg) continue;
    wrong += 1.0;
    const bool said = std::any_of(poses.begin(), poses.end(), [&](const RigidPose& pose) {
      return turn_deg(pose, truth) <= kWrong_deg;
    });
    unsaid += said ? 0.0 : 1.0;
  }
  const double n = static_cast<double>(problems.size());
  return {.turn_deg = quantile(turns, 0.5),
          .turn_p95_deg = quantile(turns, 0.95),
          .shift_mm = quantile(shifts, 0.5),
          .shift_p95_mm = quantile(shifts, 0.95),
          .wrong = wrong / n,
          .wrong_unsaid = unsaid / n};
}

}  // namespace landmarkdb::bench
