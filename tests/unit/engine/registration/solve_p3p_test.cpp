#include "engine/registration/solve_p3p.hpp"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

struct Task {
  std::array<Eigen::Vector3d, 3> bearings;
  std::array<Eigen::Vector3d, 3> points;
  Eigen::Isometry3d T_bearing_point;
};

Task make_task(Random& random) {
  Task task;
  task.T_bearing_point = testing::random_pose(random, 3.1, 5.0);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d seen(
        random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0.5, 6));
    task.bearings[i] = seen.normalized();
    task.points[i] = task.T_bearing_point.inverse() * seen;
  }
  return task;
}

TEST(SolveP3p, HasTheTruePoseAmongItsAnswersOnThousandsOfExactProblems) {
  Random random(1);
  int missed = 0;
  for (int round = 0; round < 5000; ++round) {
    const Task task = make_task(random);
    const auto poses = solve_p3p(task.bearings, task.points);
    EXPECT_LE(poses.size(), 4U);
    const bool found = std::any_of(poses.begin(), poses.end(), [&](const Eigen::Isometry3d& T) {
      return (T.matrix() - task.T_bearing_point.matrix()).cwiseAbs().maxCoeff() < 1e-5;
    });
    missed += found ? 0 : 1;
  }
  EXPECT_LE(missed, 5);  // near a double root the quartic loses half its digits
}

TEST(SolveP3p, ExplainsTheDirectionsByEachAnswer) {
  Random random(2);
  for (int round = 0; round < 500; ++round) {
    const Task task = make_task(random);
    for (const Eigen::Isometry3d& T : solve_p3p(task.bearings, task.points)) {
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT((T * task.points[i]).normalized().cross(task.bearings[i]).norm(), 1e-3);
      }
    }
  }
}

TEST(SolveP3p, FindsNothingInPointsOnALineOrInOneSpot) {
  const std::array<Eigen::Vector3d, 3> bearings = {Eigen::Vector3d(0, 0, 1),
                                                   Eigen::Vector3d(0.1, 0, 1).normalized(),
                                                   Eigen::Vector3d(0.2, 0, 1).normalized()};
  const std::array<Eigen::Vector3d, 3> line = {
      Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(1, 0, 2), Eigen::Vector3d(2, 0, 2)};
  const std::array<Eigen::Vector3d, 3> spot = {
      Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones(), Eigen::Vector3d::Ones()};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<Eigen::Vector3d, 3> none = {
      Eigen::Vector3d::Constant(nan), Eigen::Vector3d(1, 0, 2), Eigen::Vector3d(2, 1, 2)};
  EXPECT_TRUE(solve_p3p(bearings, line).empty());
  EXPECT_TRUE(solve_p3p(bearings, spot).empty());
  EXPECT_TRUE(solve_p3p(bearings, none).empty());
}

}  // namespace
}  // namespace landmarkdb
