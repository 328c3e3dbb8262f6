#include "engine/servo/target_observer.hpp"

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"

namespace landmarkdb {
namespace {

const Eigen::Vector3d kVelocity(0.02, -0.01, 0.005);
const Eigen::Vector3d kTurn(0.1, 0.2, -0.3);
constexpr double kCycle_s = 0.08;

Eigen::Isometry3d target_at(double seconds) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector(kTurn * seconds);
  T.translation() = Eigen::Vector3d(1.0, 2.0, 3.0) + kVelocity * seconds;
  return T;
}

TEST(TargetObserver, KnowsAConstantSpeedAfterTwoExactMeasurements) {
  for (const double memory : {0.0, 0.8, 0.95}) {
    TargetObserver observer(memory);
    for (int k = 0; k < 40; ++k) {
      observer.update(target_at(k * kCycle_s), kCycle_s);
      if (k < 1) continue;
      ASSERT_LT((observer.velocity() - kVelocity).norm(), 1e-9) << k;
      ASSERT_LT((observer.turn_rate() - kTurn).norm(), 1e-9) << k;
    }
    EXPECT_THAT(observer.carry(target_at(3.12), 0.5),
                testing::PoseNear(target_at(3.62), 1e-9, 1e-9));
  }
}

TEST(TargetObserver, SaysNothingMovesBeforeItHasSeenTwo) {
  TargetObserver observer(0.8);
  EXPECT_EQ(observer.velocity().norm(), 0.0);
  observer.update(target_at(7.0), kCycle_s);
  EXPECT_EQ(observer.velocity().norm(), 0.0);
  EXPECT_EQ(observer.turn_rate().norm(), 0.0);
}

TEST(TargetObserver, AveragesNoiseTheMoreTheLongerItsMemory) {
  const auto rms = [](double memory) {
    Random random(5);
    TargetObserver observer(memory);
    double sum = 0.0;
    for (int k = 0; k < 2000; ++k) {
      Eigen::Isometry3d T = target_at(0.0);
      T.translation() += 1e-3 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      observer.update(T, kCycle_s);
      if (k >= 100) sum += observer.velocity().squaredNorm();
    }
    return std::sqrt(sum / 1900.0);
  };
  EXPECT_LT(rms(0.8), 0.3 * rms(0.3));
  EXPECT_LT(rms(0.95), 0.3 * rms(0.8));
}

TEST(TargetObserver, FollowsAChangeOfSpeed) {
  TargetObserver observer(0.8);
  for (int k = 0; k < 50; ++k) observer.update(target_at(0.0), kCycle_s);
  EXPECT_LT(observer.velocity().norm(), 1e-12);
  for (int k = 0; k < 60; ++k) observer.update(target_at(k * kCycle_s), kCycle_s);
  EXPECT_LT((observer.velocity() - kVelocity).norm(), 1e-3 * kVelocity.norm());
}

TEST(TargetObserver, StartsAnewAfterReset) {
  TargetObserver observer(0.8);
  for (int k = 0; k < 9; ++k) observer.update(target_at(k * kCycle_s), kCycle_s);
  observer.reset();
  EXPECT_EQ(observer.velocity().norm(), 0.0);
  observer.update(target_at(100.0), kCycle_s);
  EXPECT_EQ(observer.velocity().norm(), 0.0);
}

}  // namespace
}  // namespace landmarkdb
