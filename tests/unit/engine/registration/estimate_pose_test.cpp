#include "engine/registration/estimate_pose.hpp"

#include <algorithm>
#include <cmath>
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
  std::vector<Correspondence> pairs;
  Eigen::Isometry3d T_target_source;
};

Task make_task(Random& random,
               std::uint32_t right,
               std::uint32_t wrong,
               double scale = 1.0,
               double noise_m = 0.0) {
  const auto draw = [&](double size) {
    return Eigen::Vector3d(
        random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
  };
  Task task;
  task.T_target_source = testing::random_pose(random, 3.1, 5.0);
  for (std::uint32_t i = 0; i < right + wrong; ++i) {
    const Eigen::Vector3d here = draw(3.0);
    const Eigen::Vector3d there =
        i < right ? Eigen::Vector3d(task.T_target_source * (scale * here) + draw(noise_m))
                  : draw(6.0);
    task.source.push_back(here.cast<float>());
    task.target.push_back(there.cast<float>());
    task.pairs.push_back({i, i, 0.0F});
  }
  return task;
}

std::optional<PoseEstimate> solve(const Task& task, const PoseOptions& options = {}) {
  return estimate_pose(task.target, task.source, task.pairs, options);
}

TEST(EstimatePose, SolvesThousandsOfExactProblems) {
  Random random(1);
  for (int round = 0; round < 2000; ++round) {
    const Task task = make_task(random, 5 + static_cast<std::uint32_t>(random.below(6)), 0);
    const auto found = solve(task);
    ASSERT_TRUE(found) << round;
    EXPECT_EQ(found->T_target_source.scale, 1.0);
    EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 1e-4, 1e-4));
    EXPECT_EQ(found->inliers.size(), task.pairs.size());
  }
}

TEST(EstimatePose, SolvesExactProblemsWithSevenOfTenPairsWrong) {
  Random random(2);
  int solved = 0;
  for (int round = 0; round < 300; ++round) {
    const Task task = make_task(random, 18, 42);
    const auto found = solve(task);
    ASSERT_TRUE(found);
    const double off = (found->T_target_source.t - task.T_target_source.translation()).norm();
    if (off < 0.02) ++solved;
    EXPECT_TRUE(std::is_sorted(found->inliers.begin(), found->inliers.end()));
  }
  EXPECT_GE(solved, 299);  // wanted with a confidence of 0.999 each
}

TEST(EstimatePose, AveragesNoiseOverAllInliers) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Task task = make_task(random, 100, 100, 1.0, 0.03);
    const auto found = solve(task);
    ASSERT_TRUE(found);
    EXPECT_GE(found->inliers.size(), 95U);
    EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 0.01, 0.005));
  }
}

TEST(EstimatePose, FindsTheScaleWhenAsked) {
  Random random(4);
  PoseOptions options;
  options.estimate_scale = true;
  for (const double scale : {0.2, 0.9, 1.0, 1.5, 4.0}) {
    const Task task = make_task(random, 20, 20, scale);
    const auto found = solve(task, options);
    ASSERT_TRUE(found) << scale;
    EXPECT_NEAR(found->T_target_source.scale, scale, 0.02 * scale);
  }
}

TEST(EstimatePose, FindsNothingWhenTooFewAgree) {
  Random random(5);
  EXPECT_FALSE(solve(make_task(random, 0, 0)));
  EXPECT_FALSE(solve(make_task(random, 3, 0)));
  PoseOptions options;
  options.min_inliers = 12;
  EXPECT_FALSE(solve(make_task(random, 10, 30), options));
  EXPECT_TRUE(solve(make_task(random, 14, 30), options));
}

TEST(EstimatePose, FindsNothingInPointsThatFixNoPose) {
  Task line;
  Task spot;
  for (std::uint32_t i = 0; i < 20; ++i) {
    line.source.emplace_back(0.5F * static_cast<float>(i), 0.0F, 0.0F);
    line.target.emplace_back(0.0F, 0.5F * static_cast<float>(i), 1.0F);
    line.pairs.push_back({i, i, 0.0F});
    spot.source.emplace_back(1.0F, 2.0F, 3.0F);
    spot.target.emplace_back(3.0F, 2.0F, 1.0F);
    spot.pairs.push_back({i, i, 0.0F});
  }
  for (const bool scale : {false, true}) {
    PoseOptions options;
    options.estimate_scale = scale;
    EXPECT_FALSE(solve(line, options));
    EXPECT_FALSE(solve(spot, options));
  }
}

TEST(EstimatePose, PassesOverPositionsThatAreNotFinite) {
  Random random(6);
  Task task = make_task(random, 12, 6);
  for (std::size_t i = 12; i < 18; ++i) {
    task.source[i].y() = std::numeric_limits<float>::quiet_NaN();
    task.target[i].x() = std::numeric_limits<float>::infinity();
  }
  const auto found = solve(task);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers.size(), 12U);
  EXPECT_THAT(found->T_target_source.matrix(), PoseNear(task.T_target_source, 1e-4, 1e-4));
  for (Eigen::Vector3f& p : task.source) p.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(solve(task));
}

TEST(EstimatePose, NamesACorrespondenceThatPointsOutsideItsArray) {
  Random random(7);
  Task task = make_task(random, 6, 0);
  task.pairs[3].target = 6;
  try {
    solve(task);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("6"));
  }
  task.pairs[3] = {100, 3, 0.0F};
  EXPECT_THROW(solve(task), Error);
}

TEST(EstimatePose, GivesTheSameAnswerForTheSameSeed) {
  Random random(8);
  const Task task = make_task(random, 20, 60, 1.0, 0.05);
  const auto a = solve(task);
  const auto b = solve(task);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->T_target_source.matrix(), b->T_target_source.matrix());
  EXPECT_EQ(a->inliers, b->inliers);
}

}  // namespace
}  // namespace landmarkdb
