#include "engine/geometry/pose.hpp"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/support/pose_near.hpp"

namespace landmarkdb {
namespace {

Eigen::Vector3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Eigen::Matrix3d random_rotation(Random& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
      .normalized()
      .toRotationMatrix();
}

TEST(NearestRotation, IsTheRotationItselfAndNeverAReflection) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d R = random_rotation(random);
    EXPECT_TRUE(nearest_rotation(R).isApprox(R, 1e-12));
    EXPECT_TRUE(nearest_rotation(1.5 * R).isApprox(R, 1e-12));
    EXPECT_NEAR(nearest_rotation(-R).determinant(), 1.0, 1e-12);
  }
}

TEST(RotationAngle, IsPreciseAtBothEnds) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
  for (const double angle : {0.0, 1e-9, 0.1, 1.0, 3.0, std::numbers::pi - 1e-9}) {
    EXPECT_NEAR(rotation_angle_rad(rotation_from_vector(angle * axis)), angle, 1e-12);
  }
}

TEST(RollPitchYaw, MultipliesOutAgain) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d R = random_rotation(random);
    const Eigen::Vector3d rpy = roll_pitch_yaw_rad(R);
    const Eigen::Matrix3d again = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                                      .toRotationMatrix();
    EXPECT_TRUE(again.isApprox(R, 1e-9));
  }
}

TEST(RollPitchYaw, GivesRollZeroAtThePole) {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()))
                                .toRotationMatrix();
  const Eigen::Vector3d rpy = roll_pitch_yaw_rad(R);
  EXPECT_EQ(rpy.x(), 0.0);
  EXPECT_NEAR(rpy.z(), 0.3, 1e-9);
}

TEST(RotationBetween, TakesOneDirectionToTheOther) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d from = random_vector(random, 2.0);
    const Eigen::Vector3d to = random_vector(random, 5.0);
    EXPECT_TRUE((rotation_between(from, to) * from.normalized()).isApprox(to.normalized(), 1e-9));
  }
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  EXPECT_TRUE((rotation_between(x, -x) * x).isApprox(-x, 1e-9));
}

TEST(RowMajor, GoesThereAndBack) {
  Random random(4);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = random_rotation(random);
  T.translation() = Eigen::Vector3d(1, 2, 3);
  const std::array<double, 16> numbers = to_row_major(T.matrix());
  EXPECT_EQ(numbers[3], 1.0);
  EXPECT_EQ(numbers[7], 2.0);
  EXPECT_EQ(numbers[15], 1.0);
  EXPECT_THAT(from_row_major(numbers), testing::PoseNear(T, 1e-12, 1e-9));
}

TEST(RowMajor, RefusesWhatIsNoPose) {
  std::array<double, 16> numbers = to_row_major(Eigen::Matrix4d::Identity());
  numbers[0] = 1.01;
  EXPECT_THROW(from_row_major(numbers), Error);
  numbers[0] = std::nan("");
  EXPECT_THROW(from_row_major(numbers), Error);
  numbers[0] = -1.0;  // a reflection
  EXPECT_THROW(from_row_major(numbers), Error);
  numbers[0] = 1.0;
  numbers[12] = 5.0;  // column by column
  EXPECT_THROW(from_row_major(numbers), Error);
}

TEST(EstimateSimilarity, FindsThousandsOfExactMotions) {
  Random random(5);
  for (int round = 0; round < 2000; ++round) {
    const Eigen::Matrix3d R = random_rotation(random);
    const Eigen::Vector3d t = random_vector(random, 10.0);
    const double scale = round % 2 == 0 ? 1.0 : random.uniform(0.2, 5.0);
    std::vector<Eigen::Vector3d> source, target;
    const std::size_t n = 3 + random.below(5);
    for (std::size_t i = 0; i < n; ++i) {
      source.push_back(random_vector(random, 2.0));
      target.push_back(scale * R * source.back() + t);
    }
    const auto found = estimate_similarity(target, source, scale != 1.0);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->R.isApprox(R, 1e-6));
    EXPECT_NEAR(found->scale, scale, 1e-6);
    EXPECT_TRUE(found->t.isApprox(t, 1e-5));
  }
}

TEST(EstimateSimilarity, HasNoAnswerForPointsThatDoNotFixAPose) {
  const std::vector<Eigen::Vector3d> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  EXPECT_FALSE(estimate_similarity(line, line, false));
  const std::vector<Eigen::Vector3d> same(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(estimate_similarity(same, same, true));
  const std::vector<Eigen::Vector3d> two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(estimate_similarity(two, two, false));
  EXPECT_FALSE(estimate_similarity({}, {}, false));
}

}  // namespace
}  // namespace landmarkdb
