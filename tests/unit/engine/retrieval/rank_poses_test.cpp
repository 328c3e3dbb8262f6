#include "engine/retrieval/rank_poses.hpp"

#include <stop_token>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::Surface;

constexpr double kCell_m = 0.05;

Proposal proposal_of(const Eigen::Isometry3d& T, std::uint32_t correspondence) {
  Proposal proposal;
  proposal.R_target_source = T.linear().cast<float>();
  proposal.t_target_source = T.translation().cast<float>();
  proposal.correspondence = correspondence;
  return proposal;
}

// A corner as the target, itself as the source: the identity is right.
struct Task {
  Surface corner = testing::corner_room(0.04);
  SurfaceGrid grid{corner.points, corner.normals, kCell_m, 2};
  TestPoints test = select_test_points(corner.points, corner.normals, {}, 512, 1);
  std::vector<Proposal> proposals;
  Eigen::Vector3d centre{1, 1, 1};

  std::vector<RankedPose> rank(const RankOptions& options, int threads = 1) const {
    RunContext context;
    context.threads = threads;
    return rank_poses(grid, test, proposals, centre, options, context);
  }
};

// Thousands of wrong proposals, and the right one among them.
Task haystack(std::size_t wrong, std::uint32_t needle) {
  Task task;
  Random random(1);
  for (std::uint32_t i = 0; i < wrong; ++i) {
    Eigen::Isometry3d T = testing::random_pose(random, 3.0, 2.0);
    if (i == needle) {
      T.setIdentity();
      T.translation().x() = 0.02;
    }
    task.proposals.push_back(proposal_of(T, i));
  }
  return task;
}

TEST(RankPoses, PutsTheRightPoseFirst) {
  const Task task = haystack(5000, 4321);
  const std::vector<RankedPose> ranked = task.rank({});
  ASSERT_FALSE(ranked.empty());
  EXPECT_EQ(ranked[0].correspondence, 4321U);
  EXPECT_THAT(ranked[0].T_target_source, PoseNear(Eigen::Isometry3d::Identity(), 0.021, 1e-6));
  EXPECT_GT(ranked[0].score, 0.8F);
  for (std::size_t i = 1; i < ranked.size(); ++i) {
    EXPECT_GE(ranked[i - 1].score, ranked[i].score);
    EXPECT_GT(ranked[i].score, 0.0F);
  }
}

// Two poses lay about as many points on the surface; one of them puts the rest where the scanner
// looked through, the other where nobody looked.
TEST(RankPoses, PutsWhatStandsInEmptySpaceBehindWhatNobodySaw) {
  Task task;
  task.corner = testing::corner_room(0.02);
  task.grid = SurfaceGrid(task.corner.points, task.corner.normals, kCell_m, 2);
  const ScannedSpace scanned(
      task.corner.points, std::vector<Eigen::Vector3f>{{1.5F, 1.5F, 1.2F}}, {}, task.grid);
  Surface source;
  Random random(4);
  source.add({0.3, 0.3, 0}, {1, 0, 0}, {0, 1, 0}, 0.04, random);    // on the floor
  source.add({0.3, 0.3, 0.9}, {1, 0, 0}, {0, 1, 0}, 0.04, random);  // and as much above it
  task.test = select_test_points(source.points, source.normals, {}, 512, 1);
  task.centre = {0.8, 0.8, 0.5};
  Eigen::Isometry3d beyond = Eigen::Isometry3d::Identity();
  beyond.translation().x() = 1.95;  // the half that was scanned a little less
  task.proposals = {proposal_of(Eigen::Isometry3d::Identity(), 0), proposal_of(beyond, 1)};
  ASSERT_EQ(task.rank({}).size(), 2U);
  const float plain = task.rank({})[0].score;
  const std::vector<RankedPose> ranked = task.rank({.scanned = &scanned});
  ASSERT_EQ(ranked.size(), 2U);
  const auto score_of = [&](std::uint32_t correspondence) {
    return ranked[0].correspondence == correspondence ? ranked[0].score : ranked[1].score;
  };
  EXPECT_LT(score_of(0), 0.3F * plain) << "half of it hangs in the room";
  EXPECT_EQ(ranked[0].correspondence, 1U);
}

TEST(RankPoses, GivesDistinctPosesAndNoMoreThanAsked) {
  Task task = haystack(300, 7);
  for (std::uint32_t i = 0; i < 100; ++i) {  // the right one again and again
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().y() = 1e-4 * i;
    task.proposals.push_back(proposal_of(T, 300 + i));
  }
  RankOptions options;
  options.hopeless = 0.0F;
  options.kept_last = 5;
  const std::vector<RankedPose> ranked = task.rank(options);
  EXPECT_LE(ranked.size(), 5U);
  EXPECT_GE(ranked.size(), 2U);
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(same_pose(ranked[i].T_target_source,
                             ranked[j].T_target_source,
                             task.centre,
                             options.same_translation_cells * kCell_m,
                             options.same_rotation_rad));
    }
  }
}

TEST(RankPoses, AnswersTheSameForAnyNumberOfThreads) {
  const Task task = haystack(3000, 1000);
  const std::vector<RankedPose> one = task.rank({}, 1);
  for (const int threads : {2, 3, 8}) {
    const std::vector<RankedPose> many = task.rank({}, threads);
    ASSERT_EQ(one.size(), many.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].score, many[i].score);
      EXPECT_EQ(one[i].correspondence, many[i].correspondence);
      EXPECT_EQ(one[i].T_target_source.matrix(), many[i].T_target_source.matrix());
    }
  }
}

TEST(RankPoses, ReturnsExactRotationsWhateverRoundingTheProposalsHave) {
  Task task;
  Proposal rough = proposal_of(Eigen::Isometry3d::Identity(), 0);
  rough.R_target_source(0, 1) += 1e-4F;
  task.proposals.push_back(rough);
  const std::vector<RankedPose> ranked = task.rank({});
  ASSERT_EQ(ranked.size(), 1U);
  const Eigen::Matrix3d R = ranked[0].T_target_source.linear();
  EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12));
}

TEST(RankPoses, HasNothingToSayWithoutProposalsOrWithHopelessOnes) {
  Task task;
  EXPECT_TRUE(task.rank({}).empty());
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 100.0;
  task.proposals.push_back(proposal_of(far, 0));
  EXPECT_TRUE(task.rank({}).empty());
}

TEST(RankPoses, StopsWhenTold) {
  const Task task = haystack(100, 1);
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  context.threads = 2;
  EXPECT_THROW(rank_poses(task.grid, task.test, task.proposals, task.centre, {}, context), Error);
}

// Proposals as poor as a half hidden keypoint makes them: the fine grid cannot tell the best of
// them from chance.
TEST(SettleBest, BringsPoorProposalsOfTheRightPoseHome) {
  Task task = haystack(3000, 3000);
  Random random(5);
  for (std::uint32_t i = 0; i < 10; ++i) {
    Eigen::Isometry3d T = testing::random_pose(random, 0.15, 0.15);
    task.proposals.push_back(proposal_of(T, 3000 + i));
  }
  const SurfaceGrid wide(task.corner.points, task.corner.normals, 3.0 * kCell_m, 2);
  RunContext context;
  for (const int threads : {1, 3}) {
    context.threads = threads;
    const std::vector<Proposal> settled =
        settle_best(wide, task.grid, task.test, task.proposals, task.centre, {}, context);
    const std::vector<RankedPose> ranked =
        rank_poses(task.grid, task.test, settled, task.centre, {}, context);
    ASSERT_FALSE(ranked.empty());
    EXPECT_THAT(ranked[0].T_target_source, PoseNear(Eigen::Isometry3d::Identity(), 0.05, 0.05));
    EXPECT_GE(ranked[0].correspondence, 3000U);
  }
}

TEST(SettleBest, KeepsNoMoreThanAsked) {
  const Task task = haystack(2000, 7);
  const SurfaceGrid wide(task.corner.points, task.corner.normals, 3.0 * kCell_m, 2);
  const auto settled =
      settle_best(wide, task.grid, task.test, task.proposals, task.centre, {.kept = 20}, {});
  EXPECT_LE(settled.size(), 20U);
  EXPECT_TRUE(settle_best(wide, task.grid, task.test, {}, task.centre, {}, {}).empty());
}

TEST(SamePose, AsksForBothPlaceAndTurn) {
  const Eigen::Isometry3d a = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d b = a;
  b.translation() = Eigen::Vector3d(0.1, 0, 0);
  EXPECT_TRUE(same_pose(a, b, {0, 0, 0}, 0.11, 0.01));
  EXPECT_FALSE(same_pose(a, b, {0, 0, 0}, 0.09, 0.01));
  b = a;
  b.linear() = rotation_from_vector({0, 0.05, 0});
  EXPECT_TRUE(same_pose(a, b, {0, 0, 0}, 0.01, 0.051));
  EXPECT_FALSE(same_pose(a, b, {0, 0, 0}, 0.01, 0.049));
  EXPECT_FALSE(same_pose(a, b, {10, 0, 0}, 0.4, 0.051)) << "the turn carries the centre away";
}

}  // namespace
}  // namespace landmarkdb
