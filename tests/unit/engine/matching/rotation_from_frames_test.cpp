#include "engine/matching/rotation_from_frames.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

Eigen::Matrix3d random_rotation(Random& random) {
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return q.normalized().toRotationMatrix();
}

struct Frames {
  std::vector<Eigen::Matrix3f> query, target;
  std::vector<Correspondence> correspondences;
};

// `right` pairs whose frames differ by R and noise, then `wrong` ones of any two frames.
Frames make_frames(const Eigen::Matrix3d& R,
                   std::size_t right,
                   std::size_t wrong,
                   double noise_rad,
                   Random& random) {
  Frames frames;
  for (std::size_t i = 0; i < right + wrong; ++i) {
    const Eigen::Matrix3d F = random_rotation(random);
    const Eigen::Vector3d w(random.normal(), random.normal(), random.normal());
    const Eigen::Matrix3d G = i < right
                                  ? Eigen::Matrix3d(rotation_from_vector(noise_rad * w) * R * F)
                                  : random_rotation(random);
    frames.query.push_back(F.cast<float>());
    frames.target.push_back(G.cast<float>());
    frames.correspondences.push_back(
        {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i), 0.0F});
  }
  return frames;
}

TEST(RotationFromFrames, FindsWhatFivePercentAgreeOn) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Matrix3d R = random_rotation(random);
    const Frames frames = make_frames(R, 20, 380, 0.05, random);
    const auto vote = rotation_from_frames(frames.correspondences, frames.target, frames.query, {});
    ASSERT_TRUE(vote.has_value());
    EXPECT_LT(rotation_angle_rad(R.transpose() * vote->R_target_query), 0.06);
    EXPECT_GE(vote->support, 18U);
    EXPECT_LE(vote->support, 26U);
    EXPECT_NEAR(vote->R_target_query.determinant(), 1.0, 1e-9);
  }
}

TEST(RotationFromFrames, IsExactForExactFramesAndHalfTurns) {
  Random random(2);
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(M_PI, 0, 0),
                                      Eigen::Vector3d(0, M_PI, 0),
                                      Eigen::Vector3d(0, 0, M_PI),
                                      Eigen::Vector3d(0, 0, 0)}) {
    const Eigen::Matrix3d R = rotation_from_vector(axis);
    const Frames frames = make_frames(R, 30, 0, 0.0, random);
    const auto vote = rotation_from_frames(frames.correspondences, frames.target, frames.query, {});
    ASSERT_TRUE(vote.has_value());
    EXPECT_LT(rotation_angle_rad(R.transpose() * vote->R_target_query), 1e-6);
    EXPECT_EQ(vote->support, 30U);
  }
}

TEST(RotationFromFrames, FindsItAmongMorePairsThanCandidates) {
  Random random(3);
  const Eigen::Matrix3d R = random_rotation(random);
  const Frames frames = make_frames(R, 300, 4700, 0.05, random);
  const auto vote = rotation_from_frames(frames.correspondences, frames.target, frames.query, {});
  ASSERT_TRUE(vote.has_value());
  EXPECT_LT(rotation_angle_rad(R.transpose() * vote->R_target_query), 0.03);
}

TEST(RotationsFromFrames, FindsEachOfThoseThatManyAgreeOnBestSupportedFirst) {
  Random random(6);
  const Eigen::Matrix3d first = random_rotation(random);
  const Eigen::Matrix3d second = rotation_from_vector(Eigen::Vector3d(0, 0, M_PI)) * first;
  Frames frames = make_frames(first, 40, 300, 0.05, random);
  const Frames other = make_frames(second, 25, 0, 0.05, random);
  for (std::size_t i = 0; i < other.correspondences.size(); ++i) {
    const auto index = static_cast<std::uint32_t>(frames.query.size());
    frames.query.push_back(other.query[i]);
    frames.target.push_back(other.target[i]);
    frames.correspondences.push_back({index, index, 0.0F});
  }
  const auto votes =
      rotations_from_frames(frames.correspondences, frames.target, frames.query, 4, {});
  ASSERT_EQ(votes.size(), 4U);
  EXPECT_LT(rotation_angle_rad(first.transpose() * votes[0].R_target_query), 0.06);
  EXPECT_LT(rotation_angle_rad(second.transpose() * votes[1].R_target_query), 0.06);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    for (std::size_t j = i + 1; j < votes.size(); ++j) {
      EXPECT_GT(rotation_angle_rad(votes[i].R_target_query.transpose() * votes[j].R_target_query),
                RotationVoteOptions().agreement_rad);
    }
  }
  EXPECT_TRUE(
      rotations_from_frames(frames.correspondences, frames.target, frames.query, 0, {}).empty());
}

TEST(RotationFromFrames, SaysNothingWhereTooFewAgree) {
  Random random(4);
  const Frames one = make_frames(Eigen::Matrix3d::Identity(), 1, 0, 0.0, random);
  EXPECT_FALSE(rotation_from_frames(one.correspondences, one.target, one.query, {}).has_value());
  EXPECT_FALSE(rotation_from_frames({}, {}, {}, {}).has_value());
  const Frames few = make_frames(Eigen::Matrix3d::Identity(), 5, 20, 0.0, random);
  EXPECT_FALSE(rotation_from_frames(few.correspondences, few.target, few.query, {.min_support = 10})
                   .has_value());
}

TEST(RotationFromFrames, RefusesIndicesOutside) {
  Random random(5);
  const Frames frames = make_frames(Eigen::Matrix3d::Identity(), 3, 0, 0.0, random);
  const std::vector<Correspondence> outside = {{0, 3, 0.0F}};
  EXPECT_THROW(rotation_from_frames(outside, frames.target, frames.query, {}), Error);
}

}  // namespace
}  // namespace landmarkdb
