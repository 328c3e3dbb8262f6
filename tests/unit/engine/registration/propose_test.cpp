#include "engine/registration/propose.hpp"

#include <gtest/gtest.h>

#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::random_pose;

struct Task {
  DescriptorSet target, source;
  std::vector<Correspondence> pairs;
  Eigen::Isometry3d T_target_source;
};

// Keypoints with frames in the source, the same carried into the target; the frames there are off
// by `tilt_rad` about a random axis.
Task task(std::uint64_t seed, std::uint32_t count, double tilt_rad = 0.0) {
  Random random(seed);
  Task made;
  made.T_target_source = random_pose(random, 3.0, 5.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Eigen::Isometry3d keypoint = random_pose(random, 3.0, 2.0);
    Eigen::Isometry3d there = made.T_target_source * keypoint;
    const Eigen::Vector3d axis = random_pose(random, 1.0, 1.0).translation().normalized();
    there.linear() = rotation_from_vector(tilt_rad * axis) * there.linear();
    made.source.keypoints.emplace_back(keypoint.translation().cast<float>());
    made.source.frames.emplace_back(keypoint.linear().cast<float>());
    made.target.keypoints.emplace_back(there.translation().cast<float>());
    made.target.frames.emplace_back(there.linear().cast<float>());
    made.pairs.push_back({i, i, 0.0F});
  }
  return made;
}

Eigen::Isometry3d pose_of(const Proposal& proposal) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = proposal.R_target_source.cast<double>();
  T.translation() = proposal.t_target_source.cast<double>();
  return T;
}

std::vector<Proposal> propose(const Task& made,
                              const std::optional<Gravity>& gravity = std::nullopt,
                              const std::optional<PositionPrior>& prior = std::nullopt) {
  return propose_from_frames(made.pairs, made.target, made.source, gravity, prior);
}

Gravity gravity_of(const Task& made) {
  Gravity gravity;
  gravity.up_target = Eigen::Vector3f::UnitZ();
  gravity.up_source =
      (made.T_target_source.linear().transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  return gravity;
}

TEST(ProposeFromFrames, GivesTheExactPoseForExactFrames) {
  const Task made = task(1, 500);
  const std::vector<Proposal> proposals = propose(made);
  ASSERT_EQ(proposals.size(), 500U);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    EXPECT_EQ(proposals[i].correspondence, i);
    EXPECT_THAT(pose_of(proposals[i]), PoseNear(made.T_target_source, 1e-4, 1e-5));
  }
}

TEST(ProposeFromFrames, TakesQueryIndicesForTheSourceAndTargetOnesForTheTarget) {
  Task made = task(2, 3);
  std::swap(made.target.keypoints[0], made.target.keypoints[2]);
  std::swap(made.target.frames[0], made.target.frames[2]);
  made.pairs = {{0, 2, 0.0F}, {2, 0, 0.0F}};
  for (const Proposal& proposal : propose(made)) {
    EXPECT_THAT(pose_of(proposal), PoseNear(made.T_target_source, 1e-4, 1e-5));
  }
}

TEST(ProposeFromFrames, DropsWhatTiltsTooFarAndSnapsTheRestUpright) {
  Task made = task(3, 400, 0.25);
  for (std::size_t i = 0; i < 400; i += 2) {  // every other frame is turned over
    made.target.frames[i] =
        Eigen::Matrix3f(made.target.frames[i] * Eigen::Vector3f(1, -1, -1).asDiagonal());
  }
  const Gravity gravity = gravity_of(made);
  const std::vector<Proposal> proposals = propose(made, gravity);
  EXPECT_LT(proposals.size(), 250U);
  EXPECT_GT(proposals.size(), 150U);
  for (const Proposal& proposal : proposals) {
    const Eigen::Vector3f up = proposal.R_target_source * gravity.up_source;
    EXPECT_LT((up - gravity.up_target).norm(), 1e-5F) << "snapped";
    EXPECT_TRUE(
        (proposal.R_target_source * proposal.R_target_source.transpose()).isIdentity(1e-5F));
    const Correspondence& pair = made.pairs[proposal.correspondence];
    const Eigen::Vector3f there =
        proposal.R_target_source * made.source.keypoints[pair.query] + proposal.t_target_source;
    EXPECT_LT((there - made.target.keypoints[pair.target]).norm(), 1e-5F)
        << "turned about its keypoint";
    if (pair.query % 2 == 0) continue;  // turned over about a level axis it may stand upright
    const Eigen::Matrix3d R = proposal.R_target_source.cast<double>();
    EXPECT_LT(rotation_angle_rad(made.T_target_source.linear().transpose() * R), 0.2501)
        << "upright is no further off than before";
  }
}

TEST(ProposeFromFrames, KeepsTwentyDegreesOfTiltAndNoMore) {
  for (const double tilt_rad : {0.33, 0.37}) {
    Task made = task(4, 1);
    const Gravity gravity = gravity_of(made);
    // Tilted about a level axis: all of it counts.
    made.target.frames[0] =
        rotation_from_vector({tilt_rad, 0, 0}).cast<float>() * made.target.frames[0];
    EXPECT_EQ(propose(made, gravity).size(), tilt_rad < 0.35 ? 1U : 0U) << tilt_rad;
  }
}

TEST(ProposeFromFrames, KeepsOnlySensorsNearThePrior) {
  const Task made = task(5, 200, 0.5);
  PositionPrior prior;
  prior.centre = made.T_target_source.translation().cast<float>();
  prior.radius_m = 0.4F;
  const std::vector<Proposal> near = propose(made, std::nullopt, prior);
  const std::vector<Proposal> all = propose(made);
  EXPECT_LT(near.size(), all.size());
  EXPECT_GT(near.size(), 0U);
  std::size_t within = 0;
  for (const Proposal& proposal : all) {
    if ((proposal.t_target_source - prior.centre).norm() <= prior.radius_m) ++within;
  }
  EXPECT_EQ(near.size(), within);
}

TEST(ProposeFromFrames, MeasuresThePriorWhereTheSensorIsAndNotAtTheFramesZero) {
  const Task made = task(7, 20);
  PositionPrior prior;
  prior.sensor_source = Eigen::Vector3f(10, 20, 30);
  prior.radius_m = 0.1F;
  prior.centre = (made.T_target_source * Eigen::Vector3d(10, 20, 30)).cast<float>();
  EXPECT_EQ(propose(made, std::nullopt, prior).size(), 20U);
  prior.centre = made.T_target_source.translation().cast<float>();
  EXPECT_TRUE(propose(made, std::nullopt, prior).empty());
}

TEST(ProposeFromFrames, ProposesNothingWithoutCorrespondences) {
  EXPECT_TRUE(propose(task(6, 0)).empty());
}

}  // namespace
}  // namespace landmarkdb
