#include "bench/mono/poses.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "bench/mono/pose_peer.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/point_pose.hpp"

namespace landmarkdb::bench {
namespace {

constexpr double kNoise_px = 0.5;
constexpr double kWrong_deg = 15.0;

struct Problem {
  std::vector<PosePoint> points;
  RigidPose truth;
};

Camera camera() {
  Camera made;
  made.width = 640;
  made.height = 480;
  made.fx = made.fy = 600.0;
  made.cx = 320.0;
  made.cy = 240.0;
  return made;
}

Problem draw(Random& random, const Camera& seen_by, std::size_t n, bool planar) {
  for (;;) {
    Problem problem;
    const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
    problem.truth.R = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
    problem.truth.t = {
        random.uniform(-0.2, 0.2), random.uniform(-0.15, 0.15), random.uniform(0.8, 1.2)};
    // A plane that is seen edge-on shows no points.
    constexpr double kLeastCosine = 0.2;
    const Eigen::Vector3d sight = problem.truth.t.normalized();
    bool usable = !planar || std::abs(sight.dot(problem.truth.R.col(2))) > kLeastCosine;
    for (std::size_t i = 0; i < n; ++i) {
      PosePoint point;
      point.xyz = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
      if (planar) point.xyz.z() = 0.0;
      if (planar && n == 4) point.xyz = {i % 2 == 0 ? -0.1 : 0.1, i < 2 ? -0.1 : 0.1, 0.0};
      const auto uv = project(seen_by, problem.truth * point.xyz);
      usable = usable && uv;
      if (uv) point.uv = *uv + kNoise_px * Eigen::Vector2d(random.normal(), random.normal());
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

template <typename Solve>
PoseColumn measure(const std::string& points,
                   const std::string& method,
                   const std::vector<Problem>& problems,
                   const Solve& solve) {
  PoseColumn column{.points = points, .method = method};
  std::vector<double> turns, shifts;
  std::vector<PointPoses> found;
  found.reserve(problems.size());
  const auto start = std::chrono::steady_clock::now();
  for (const Problem& problem : problems) found.push_back(solve(problem));
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
  column.us = took.count() / static_cast<double>(problems.size());
  double wrong = 0.0, unsaid = 0.0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const PointPoses& poses = found[i];
    const double off = poses.count > 0 ? turn_deg(poses.poses[0].pose, problems[i].truth) : 180.0;
    turns.push_back(off);
    shifts.push_back(poses.count > 0 ? (poses.poses[0].pose.t - problems[i].truth.t).norm() * 1e3
                                     : 1e6);
    if (off <= kWrong_deg) continue;
    wrong += 1.0;
    const bool said =
        poses.count == 2 && turn_deg(poses.poses[1].pose, problems[i].truth) <= kWrong_deg;
    unsaid += said ? 0.0 : 1.0;
  }
  column.turn_deg = quantile(turns, 0.5);
  column.turn_p95_deg = quantile(turns, 0.95);
  column.shift_mm = quantile(shifts, 0.5);
  column.shift_p95_mm = quantile(shifts, 0.95);
  column.wrong = wrong / static_cast<double>(problems.size());
  column.wrong_unsaid = unsaid / static_cast<double>(problems.size());
  return column;
}

}  // namespace

std::vector<PoseColumn> run_poses(std::size_t poses, std::uint64_t seed) {
  const Camera seen_by = camera();
  struct Set {
    const char* name;
    std::size_t n;
    bool planar;
  };
  std::vector<PoseColumn> columns;
  for (const Set& set : {Set{"general n=4", 4, false},
                         Set{"general n=10", 10, false},
                         Set{"planar square n=4", 4, true},
                         Set{"planar n=10", 10, true}}) {
    Random random(seed);
    std::vector<Problem> problems;
    for (std::size_t i = 0; i < poses; ++i)
      problems.push_back(draw(random, seen_by, set.n, set.planar));
    columns.push_back(measure(set.name, "bound", problems, [&](const Problem& problem) {
      return refine_points(problem.points, seen_by, problem.truth, {});
    }));
    columns.push_back(measure(set.name, "ours", problems, [&](const Problem& problem) {
      return solve_points(problem.points, seen_by, {});
    }));
    for (const PosePeer& peer : pose_peers(set.n, set.planar)) {
      columns.push_back(measure(set.name, peer.name, problems, [&](const Problem& problem) {
        PointPoses found;
        found.count = peer.solve(problem.points, seen_by, found.poses[0].pose) ? 1 : 0;
        return found;
      }));
    }
  }
  return columns;
}

}  // namespace landmarkdb::bench
