// landmarkdb-bench-pose: our pose solvers beside OpenCV's and OpenGV's, on the same points in one
// run.
//
// Counters: `a_pose`, the time of one; `deg` and `mm`, median errors; `of_bound` and
// `of_bound_p95`, the turn's median and 95 % point as shares of those of the maximum-likelihood
// bound (the least-squares minimum reached from the true pose; no unbiased solver is better);
// `wrong`, the share of poses over 15 degrees off; `unsaid`, that of wrong poses which no second
// pose put right. Of three points nothing is a bound, and their image is exact: the pose nearest to
// the truth counts.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/micro/pose_peer.hpp"
#include "bench/micro/pose_problems.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/point_pose.hpp"
#include "engine/mono/triple_pose.hpp"

namespace {

using namespace landmarkdb;
using namespace landmarkdb::bench;

constexpr std::size_t kProblems = 1000;
constexpr std::uint64_t kSeed = 10000;  // nothing was tuned on it

using Solve = std::function<FoundPoses(const PoseProblem&)>;

struct Set {
  std::string name;
  std::vector<PoseProblem> problems;
  PoseErrors bound;
  bool nearest = false;  // of several poses the one nearest to the truth counts
};

void put_nearest_first(const PoseProblem& problem, FoundPoses& found) {
  const auto off = [&](const RigidPose& pose) {
    return rotation_angle_rad(pose.R.transpose() * problem.truth.R);
  };
  std::sort(found.begin(), found.end(), [&](const RigidPose& a, const RigidPose& b) {
    return off(a) < off(b);
  });
}

PoseErrors errors_with(const Set& set, const Solve& solve) {
  std::vector<FoundPoses> found;
  for (const PoseProblem& problem : set.problems) {
    found.push_back(solve(problem));
    if (set.nearest) put_nearest_first(problem, found.back());
  }
  return errors_of(set.problems, found);
}

void run(benchmark::State& state, const Set& set, const Solve& solve) {
  for (auto _ : state) {
    for (const PoseProblem& problem : set.problems) benchmark::DoNotOptimize(solve(problem));
  }
  const PoseErrors errors = errors_with(set, solve);
  state.counters["a_pose"] = benchmark::Counter(
      static_cast<double>(set.problems.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["deg"] = errors.turn_deg;
  state.counters["mm"] = errors.shift_mm;
  if (set.bound.turn_deg > 0.0) {
    state.counters["of_bound"] = errors.turn_deg / set.bound.turn_deg;
    state.counters["of_bound_p95"] = errors.turn_p95_deg / set.bound.turn_p95_deg;
  }
  state.counters["wrong"] = errors.wrong;
  state.counters["unsaid"] = errors.wrong_unsaid;
}

FoundPoses poses_of(const PointPoses& poses) {
  FoundPoses found;
  for (int i = 0; i < poses.count; ++i) {
    found.push_back(poses.poses[static_cast<std::size_t>(i)].pose);
  }
  return found;
}

void add(const std::shared_ptr<const Set>& set, const std::string& method, const Solve& solve) {
  benchmark::RegisterBenchmark((set->name + "/" + method).c_str(),
                               [set, solve](benchmark::State& state) { run(state, *set, solve); })
      ->Unit(benchmark::kMillisecond);
}

void add_peers(const std::shared_ptr<const Set>& set, std::size_t n, bool planar) {
  for (const auto& peers : {opencv_pose_peers(n, planar), opengv_pose_peers(n, planar)}) {
    for (const PosePeer& peer : peers) {
      add(set, peer.name, [peer](const PoseProblem& problem) {
        return peer.solve(problem.points, pose_camera());
      });
    }
  }
}

void add_set(const std::string& name, std::size_t n, bool planar) {
  auto set = std::make_shared<Set>();
  set->name = name;
  set->problems = draw_problems({.points = n, .planar = planar}, kProblems, kSeed);
  const Solve bound = [](const PoseProblem& problem) {
    return poses_of(refine_points(problem.points, pose_camera(), problem.truth, {}));
  };
  set->bound = errors_with(*set, bound);
  add(set, "bound", bound);
  add(set, "ours", [](const PoseProblem& problem) {
    return poses_of(solve_points(problem.points, pose_camera(), {}));
  });
  add_peers(set, n, planar);
}

struct Triple {
  ModelTriple model;
  std::array<Eigen::Vector3d, 3> points_m;
  std::array<Eigen::Vector2d, 3> rays;
};

// As recognition has it: the model's side was worked out before, the rays once an image.
Triple triple_of(const PoseProblem& problem) {
  const Camera camera = pose_camera();
  Triple triple;
  for (std::size_t i = 0; i < 3; ++i) {
    triple.points_m[i] = problem.points[i].xyz;
    triple.rays[i] = undistort(camera, problem.points[i].uv).value_or(Eigen::Vector2d::Zero());
  }
  complete_triple(triple.points_m, triple.model);
  return triple;
}

void add_triples() {
  auto set = std::make_shared<Set>();
  set->name = "three points";
  set->problems = draw_problems({.points = 3, .noise_px = 0.0}, kProblems, kSeed);
  set->nearest = true;
  auto triples = std::make_shared<std::vector<Triple>>();
  for (const PoseProblem& problem : set->problems) triples->push_back(triple_of(problem));
  const auto add_ours = [&](const std::string& name, int rounds, const auto& solve) {
    const auto by_problem = [set, triples, rounds, solve](const PoseProblem& problem) {
      const auto i = static_cast<std::size_t>(&problem - set->problems.data());
      const Triple& triple = (*triples)[i];
      const TriplePoses poses = solve(triple.model, triple.rays);
      FoundPoses found;
      for (int k = 0; k < poses.count; ++k) {
        const RigidPose& pose = poses.poses[static_cast<std::size_t>(k)];
        found.push_back(
            rounds == 0
                ? pose
                : correct_perspective(triple.model, triple.points_m, triple.rays, pose, rounds));
      }
      return found;
    };
    add(set, name, by_problem);
  };
  add_ours("ours, weak perspective", 0, solve_triple);
  add_ours("ours, in sight", 0, solve_triple_in_sight);
  add_ours("ours, in sight, 2 rounds", 2, solve_triple_in_sight);
  // Without the vector that the peers' interface asks for.
  const auto add_bare = [&](const char* name, auto solve) {
    benchmark::RegisterBenchmark(name, [triples, solve](benchmark::State& state) {
      for (auto _ : state) {
        for (const Triple& t : *triples) benchmark::DoNotOptimize(solve(t.model, t.rays));
      }
      state.counters["a_pose"] = benchmark::Counter(
          static_cast<double>(triples->size()),
          benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    })->Unit(benchmark::kMillisecond);
  };
  add_bare("three points/ours, weak perspective, bare", solve_triple);
  add_bare("three points/ours, in sight, bare", solve_triple_in_sight);
  add_peers(set, 3, false);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_triples();
  for (const std::size_t n : {4, 5, 6, 8, 10}) {
    add_set("general n=" + std::to_string(n), n, false);
  }
  add_set("planar square n=4", 4, true);
  add_set("planar n=10", 10, true);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
