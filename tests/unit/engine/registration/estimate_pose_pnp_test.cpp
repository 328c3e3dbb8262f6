#include "engine/registration/estimate_pose_pnp.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;

struct Task {
  std::vector<Eigen::Vector3f> target, source;
  Eigen::Vector3d viewpoint{0.3, -0.2, 0.1};
  std::vector<Correspondence> pairs;
  Eigen::Isometry3d T_target_source;
};

// `stretch`: the source's ranges are off by this factor at most, their directions exact.
Task make_task(Random& random, std::uint32_t right, std::uint32_t wrong, double stretch = 1.0) {
  Task task;
  task.T_target_source = testing::random_pose(random, 3.1, 5.0);
  for (std::uint32_t i = 0; i < right + wrong; ++i) {
    const Eigen::Vector3d here(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(1, 6));
    const Eigen::Vector3d elsewhere(
        random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6));
    task.target.push_back(
        (i < right ? Eigen::Vector3d(task.T_target_source * here) : elsewhere).cast<float>());
    const double factor = random.uniform(1.0 / stretch, stretch);
    task.source.push_back((task.viewpoint + factor * (here - task.viewpoint)).cast<float>());
    task.pairs.push_back({i, i, 0.0F});
  }
  return task;
}

std::optional<PoseEstimate> solve(const Task& task, const PoseOptions& options = {}) {
  return estimate_pose_pnp(task.target, task.source, task.viewpoint, task.pairs, options);
}

TEST(EstimatePosePnp, SolvesExactProblems) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    const Task task = make_task(random, 12, 0);
    const auto found = solve(task);
    ASSERT_TRUE(found) << round;
    EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 1e-3, 1e-3));
    EXPECT_EQ(found->T_target_source.scale, 1.0);
  }
}

TEST(EstimatePosePnp, NeedsDirectionsOnly) {
  Random random(2);
  for (int round = 0; round < 100; ++round) {
    const Task task = make_task(random, 12, 0, 3.0);
    const auto found = solve(task);
    ASSERT_TRUE(found) << round;
    EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 1e-3, 1e-3));
  }
}

TEST(EstimatePosePnp, SolvesProblemsWithHalfOfThePairsWrong) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Task task = make_task(random, 20, 20);
    const auto found = solve(task);
    ASSERT_TRUE(found) << round;
    EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 0.05, 0.02));
    EXPECT_GE(found->inliers.size(), 20U);
  }
}

TEST(EstimatePosePnp, FindsNothingWhenTooFewAgree) {
  Random random(4);
  EXPECT_FALSE(solve(make_task(random, 0, 0)));
  EXPECT_FALSE(solve(make_task(random, 3, 0)));
  PoseOptions options;
  options.min_inliers = 12;
  EXPECT_FALSE(solve(make_task(random, 8, 10), options));
}

TEST(EstimatePosePnp, PassesOverWhatIsNotFiniteOrAtTheEye) {
  Random random(5);
  Task task = make_task(random, 12, 4);
  task.source[12] = task.viewpoint.cast<float>();
  task.source[13].setConstant(std::numeric_limits<float>::quiet_NaN());
  task.target[14].setConstant(std::numeric_limits<float>::infinity());
  const auto found = solve(task);
  ASSERT_TRUE(found);
  EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 1e-2, 1e-2));
}

TEST(EstimatePosePnp, NamesACorrespondenceThatPointsOutsideItsArray) {
  Random random(6);
  Task task = make_task(random, 6, 0);
  task.pairs[3].target = 6;
  EXPECT_THROW(solve(task), Error);
}

TEST(EstimatePosePnp, GivesTheSameAnswerForTheSameSeed) {
  Random random(7);
  const Task task = make_task(random, 15, 30);
  const auto a = solve(task);
  const auto b = solve(task);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->T_target_source.matrix(), b->T_target_source.matrix());
}

}  // namespace
}  // namespace landmarkdb
