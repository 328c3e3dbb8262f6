#include "engine/geometry/pose.hpp"

#include <array>
#include <cmath>
#include <limits>
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

TEST(NearestRotation, UndoesSmallErrorsOfEveryEntry) {
  Random random(11);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d R = random_rotation(random);
    Eigen::Matrix3d off = R;
    for (int k = 0; k < 9; ++k) off(k) += random.uniform(-1e-4, 1e-4);
    const Eigen::Matrix3d near = nearest_rotation(off);
    EXPECT_TRUE((near * near.transpose()).isIdentity(1e-12));
    EXPECT_NEAR(near.determinant(), 1.0, 1e-12);
    EXPECT_LT(rotation_angle_rad(near.transpose() * R), 5e-4);
    EXPECT_LE((near - off).norm(), (R - off).norm() + 1e-12) << "R itself is nearer";
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

TEST(RollPitchYaw, TurnsAboutTheAxesItNames) {
  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return roll_pitch_yaw_rad(Eigen::AngleAxisd(angle, axis).toRotationMatrix());
  };
  EXPECT_TRUE(about(0.4, Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(0.4, 0, 0), 1e-12));
  EXPECT_TRUE(about(0.4, Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d(0, 0.4, 0), 1e-12));
  EXPECT_TRUE(about(-2.4, Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(0, 0, -2.4), 1e-12));
}

TEST(RollPitchYaw, MultipliesOutAtAndBesideBothPoles) {
  for (const double pole : {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi}) {
    for (const double beside : {0.0, 1e-12, 1e-10, 1e-8, 1e-6, -1e-6}) {
      for (const double roll : {-2.0, 0.0, 0.7}) {
        for (const double yaw : {-1.5, 0.0, 3.0}) {
          const auto turn = [](double r, double p, double y) {
            return (Eigen::AngleAxisd(y, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(p, Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(r, Eigen::Vector3d::UnitX()))
                .toRotationMatrix();
          };
          const Eigen::Matrix3d R = turn(roll, pole + beside, yaw);
          const Eigen::Vector3d rpy = roll_pitch_yaw_rad(R);
          EXPECT_TRUE(rpy.allFinite());
          EXPECT_TRUE(turn(rpy.x(), rpy.y(), rpy.z()).isApprox(R, 1e-7))
              << pole << " " << beside << " " << roll << " " << yaw;
        }
      }
    }
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

TEST(EstimateSimilarity, FollowsTheWeights) {
  Random random(6);
  std::vector<Eigen::Vector3d> source, target;
  std::vector<double> weights;
  const Eigen::Matrix3d R = random_rotation(random);
  for (int i = 0; i < 8; ++i) {
    source.push_back(random_vector(random, 2.0));
    const bool wrong = i % 2 == 1;
    target.push_back(wrong ? random_vector(random, 5.0) : Eigen::Vector3d(R * source.back()));
    weights.push_back(wrong ? 0.0 : 1.0 + i);
  }
  const auto found = estimate_similarity(target, source, true, weights);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->R.isApprox(R, 1e-9));
  EXPECT_NEAR(found->scale, 1.0, 1e-9);
  EXPECT_LT(found->t.norm(), 1e-9);
  EXPECT_FALSE(estimate_similarity(target, source, true, std::vector<double>(8, 0.0)));
}

TEST(EstimateSimilarity, IsTheLeastSquaresAnswerOfNoisyPairs) {
  Random random(7);
  for (int round = 0; round < 100; ++round) {
    const Eigen::Matrix3d R = random_rotation(random);
    const Eigen::Vector3d t = random_vector(random, 3.0);
    std::vector<Eigen::Vector3d> source, target;
    for (int i = 0; i < 12; ++i) {
      source.push_back(random_vector(random, 2.0));
      target.push_back(R * source.back() + t + random_vector(random, 0.05));
    }
    const auto found = estimate_similarity(target, source, false);
    ASSERT_TRUE(found);
    const auto cost = [&](const Eigen::Matrix3d& R_, const Eigen::Vector3d& t_) {
      double sum = 0.0;
      for (std::size_t i = 0; i < source.size(); ++i)
        sum += (R_ * source[i] + t_ - target[i]).squaredNorm();
      return sum;
    };
    const double best = cost(found->R, found->t);
    EXPECT_EQ(found->scale, 1.0);
    EXPECT_LE(best, cost(R, t));
    for (int nudge = 0; nudge < 20; ++nudge) {
      const Eigen::Matrix3d turned = rotation_from_vector(random_vector(random, 0.01)) * found->R;
      EXPECT_LE(best, cost(turned, found->t + random_vector(random, 0.01)) + 1e-12);
    }
  }
}

TEST(EstimateSimilarity, TurnsMirroredPointsAsBestItCanButNeverMirrors) {
  Random random(8);
  for (int round = 0; round < 200; ++round) {
    std::vector<Eigen::Vector3d> source, target;
    for (int i = 0; i < 6; ++i) {
      source.push_back(random_vector(random, 1.0));
      target.push_back(Eigen::Vector3d(-source.back().x(), source.back().y(), source.back().z()));
    }
    const auto found = estimate_similarity(target, source, round % 2 == 0);
    if (!found) continue;  // with a scale there may be none above zero
    EXPECT_NEAR(found->R.determinant(), 1.0, 1e-9);
    EXPECT_GT(found->scale, 0.0);
  }
}

TEST(EstimateSimilarity, TakesPointsOnOnePlane) {
  Random random(9);
  for (int round = 0; round < 500; ++round) {
    const Eigen::Matrix3d R = random_rotation(random);
    std::vector<Eigen::Vector3d> source, target;
    for (int i = 0; i < 4; ++i) {
      source.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), 0.0);
      target.push_back(R * source.back());
    }
    const auto found = estimate_similarity(target, source, false);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->R.isApprox(R, 1e-5));
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
  const std::vector<Eigen::Vector3d> far_line{{1e6, 2e6, 3e6},
                                              {1e6 + 1, 2e6 + 1, 3e6 + 1},
                                              {1e6 + 2, 2e6 + 2, 3e6 + 2},
                                              {1e6 + 5, 2e6 + 5, 3e6 + 5}};
  EXPECT_FALSE(estimate_similarity(far_line, far_line, false));
}

TEST(EstimateSimilarity, HasNoAnswerForNumbersThatAreNotFinite) {
  const std::vector<Eigen::Vector3d> good{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t i = 0; i < good.size(); ++i) {
      std::vector<Eigen::Vector3d> broken = good;
      broken[i].y() = bad;
      // A good call in between: what it leaves behind must not be taken for an answer.
      EXPECT_TRUE(estimate_similarity(good, good, true));
      EXPECT_FALSE(estimate_similarity(broken, good, false)) << bad << " in target " << i;
      EXPECT_TRUE(estimate_similarity(good, good, true));
      EXPECT_FALSE(estimate_similarity(good, broken, true)) << bad << " in source " << i;
    }
  }
}

}  // namespace
}  // namespace landmarkdb
