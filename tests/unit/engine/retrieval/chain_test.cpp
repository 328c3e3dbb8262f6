#include "engine/retrieval/chain.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;

Eigen::Vector3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Eigen::Isometry3d random_pose(Random& random) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector(random_vector(random, 2.0));
  T.translation() = random_vector(random, 5.0);
  return T;
}

// Query keypoints with frames, and the same on the entry's surface; every pair is right, but the
// last `wrong` ones lie elsewhere.
struct Recognised {
  DescriptorSet query;
  DescriptorSet entry;
  std::vector<Correspondence> pairs;
  Eigen::Isometry3d T_entry_sensor;

  ChainInput input(double inlier_m, bool estimate_scale) const {
    return {.query = query,
            .entry = entry,
            .correspondences = pairs,
            .proposer = 0,
            .T_entry_sensor = T_entry_sensor,
            .inlier_m = inlier_m,
            .estimate_scale = estimate_scale};
  }
};

Recognised recognise(std::uint64_t seed,
                     std::uint32_t pairs,
                     std::uint32_t wrong,
                     double scale = 1.0,
                     double noise_m = 0.0) {
  Random random(seed);
  Recognised made;
  made.T_entry_sensor = random_pose(random);
  for (std::uint32_t i = 0; i < pairs; ++i) {
    const Eigen::Vector3d here = random_vector(random, 2.0);
    Eigen::Vector3d there = made.T_entry_sensor.linear() * (scale * here) +
                            made.T_entry_sensor.translation() + random_vector(random, noise_m);
    if (i + wrong >= pairs) there += Eigen::Vector3d(3, 3, 3);
    const Eigen::Matrix3d frame = random_pose(random).linear();
    made.query.keypoints.push_back(here.cast<float>());
    made.query.frames.emplace_back(frame.cast<float>());
    made.entry.keypoints.push_back(there.cast<float>());
    made.entry.frames.emplace_back((made.T_entry_sensor.linear() * frame).cast<float>());
    made.pairs.push_back({i, i, 0.1F});
  }
  return made;
}

Eigen::Matrix4d product(const PoseChain& chain) {
  return chain.T_icp * chain.T_scene_landmark * chain.T_landmark_sensor;
}

bool is_rigid(const Eigen::Matrix4d& T) {
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  return (R * R.transpose()).isIdentity(1e-9) && R.determinant() > 0.0 &&
         T.row(3) == Eigen::RowVector4d(0, 0, 0, 1);
}

TEST(MakeChain, MultipliesOutToTheRefinedPose) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Recognised made = recognise(seed, 12, 4, 1.0, 0.02);
    const ChainResult result = make_chain(made.input(0.1, false));
    EXPECT_TRUE(result.T_entry_sensor.isApprox(product(result.chain), 1e-12));
    EXPECT_THAT(result.T_entry_sensor, PoseNear(made.T_entry_sensor, 1e-9, 1e-9));
    EXPECT_TRUE(is_rigid(result.chain.T_landmark_sensor));
    EXPECT_TRUE(is_rigid(result.chain.T_scene_landmark));
    EXPECT_TRUE(is_rigid(result.chain.T_icp));
    EXPECT_EQ(result.chain.scale, 1.0);
  }
}

TEST(MakeChain, LeavesRefinementNothingToDoWhenThePairsAreExact) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Recognised made = recognise(seed, 6, 0);
    const ChainResult result = make_chain(made.input(0.1, false));
    EXPECT_THAT(result.chain.T_icp, PoseNear(Eigen::Isometry3d::Identity(), 1e-4, 1e-5));
  }
}

TEST(MakeChain, PutsTheProposersKeypointAtTheLandmarksZero) {
  const Recognised made = recognise(3, 8, 0);
  const ChainResult result = make_chain(made.input(0.1, false));
  const Eigen::Vector4d keypoint = made.query.keypoints[0].cast<double>().homogeneous();
  EXPECT_LT((result.chain.T_landmark_sensor * keypoint).head<3>().norm(), 1e-6);
}

TEST(MakeChain, CountsAsInliersThePairsThatThePoseAgreesWith) {
  const Recognised made = recognise(4, 10, 3);
  EXPECT_EQ(make_chain(made.input(0.1, false)).inliers,
            (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(MakeChain, TakesTheSimilarityFromFourPairsOn) {
  // The entry's frames are turned, so that the frames and the positions tell different stories.
  Recognised made = recognise(5, 4, 0);
  for (Eigen::Matrix3f& frame : made.entry.frames) {
    frame = rotation_from_vector({0.2, 0, 0}).cast<float>() * frame;
  }
  const ChainResult four = make_chain(made.input(0.1, false));
  EXPECT_THAT(four.chain.T_icp, PoseNear(Eigen::Isometry3d::Identity(), 1e-4, 1e-5));

  made.pairs.pop_back();  // three: the frames have to do
  const ChainResult three = make_chain(made.input(0.1, false));
  EXPECT_NEAR(rotation_angle_rad(three.chain.T_icp.topLeftCorner<3, 3>()), 0.2, 1e-5);
  EXPECT_THAT(three.T_entry_sensor, PoseNear(made.T_entry_sensor, 1e-9, 1e-9));
  const Eigen::Vector3d landmark = three.chain.T_scene_landmark.topRightCorner<3, 1>();
  EXPECT_TRUE(landmark.isApprox(made.entry.keypoints[0].cast<double>(), 1e-9));
}

TEST(MakeChain, FallsBackToTheFramesWhenThePairsLieOnOneLine) {
  Recognised made = recognise(6, 5, 0);
  for (std::size_t i = 0; i < 5; ++i) {
    const Eigen::Vector3d here = Eigen::Vector3d(0.1, 0.2, 0.3) * static_cast<double>(i);
    made.query.keypoints[i] = here.cast<float>();
    made.entry.keypoints[i] = (made.T_entry_sensor * here).cast<float>();
  }
  const ChainResult result = make_chain(made.input(0.1, false));
  EXPECT_THAT(result.T_entry_sensor, PoseNear(made.T_entry_sensor, 1e-9, 1e-9));
  EXPECT_TRUE(is_rigid(result.chain.T_icp));
}

TEST(MakeChain, AnswersEvenWhenNoPairAgrees) {
  const Recognised made = recognise(7, 5, 5);
  const ChainResult result = make_chain(made.input(0.1, true));
  EXPECT_TRUE(result.inliers.empty());
  EXPECT_THAT(result.T_entry_sensor, PoseNear(made.T_entry_sensor, 1e-9, 1e-9));
}

TEST(MakeChain, TellsTheScaleWhenAskedAndStillMultipliesOut) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Recognised made = recognise(seed, 12, 0, 1.02);
    const ChainResult result = make_chain(made.input(0.3, true));
    ASSERT_EQ(result.inliers.size(), 12U);
    EXPECT_NEAR(result.chain.scale, 1.02, 1e-5);
    const double stretch =
        std::cbrt(result.chain.T_scene_landmark.topLeftCorner<3, 3>().determinant());
    EXPECT_NEAR(stretch, result.chain.scale, 1e-9);
    EXPECT_TRUE(result.T_entry_sensor.isApprox(product(result.chain), 1e-12));
  }
}

TEST(MakeChain, KeepsTheScaleAtOneUnlessAsked) {
  const Recognised made = recognise(8, 12, 0, 1.02);
  EXPECT_EQ(make_chain(made.input(0.3, false)).chain.scale, 1.0);
}

}  // namespace
}  // namespace landmarkdb
