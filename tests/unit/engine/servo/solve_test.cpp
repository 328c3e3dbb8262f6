#include "engine/servo/solve.hpp"

#include <cmath>

#include <Eigen/LU>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "tests/support/servo_arms.hpp"

namespace landmarkdb {
namespace {

using testing::puma_560;

Eigen::MatrixXd random_matrix(Random& random, Eigen::Index rows, Eigen::Index cols) {
  Eigen::MatrixXd A(rows, cols);
  for (Eigen::Index i = 0; i < A.size(); ++i) A.data()[i] = random.normal();
  return A;
}

TEST(PseudoInverse, HasThePropertiesOfMooreAndPenrose) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd A = random_matrix(random, 5, 6) * 10.0;
    const PseudoInverse result = pseudo_inverse(A, {});
    if (result.damped) continue;
    EXPECT_EQ(result.rank, 5);
    EXPECT_LT((A * result.inverse * A - A).norm(), 1e-9);
    EXPECT_LT((A * result.inverse - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-9);
    EXPECT_LT((A * result.free).norm(), 1e-9) << "free motion does not disturb the task";
    EXPECT_LT((result.free - (Eigen::MatrixXd::Identity(6, 6) - result.inverse * A)).norm(), 1e-9);
  }
}

TEST(PseudoInverse, CutsWhatIsBelowTheShareOfTheLargest) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3, 3);
  A.diagonal() << 1000.0, 1.0, 0.09;
  const PseudoInverse result = pseudo_inverse(A, {});
  EXPECT_EQ(result.rank, 2);
  EXPECT_NEAR(result.smallest, 1.0, 1e-12);
  EXPECT_NEAR(result.free(2, 2), 1.0, 1e-12);
  EXPECT_EQ(pseudo_inverse(Eigen::MatrixXd::Zero(2, 3), {}).rank, 0);
}

TEST(PseudoInverse, IsDampedWithoutAJumpAndOnlyInTheWeakDirection) {
  const auto gain = [](double s) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2, 2);
    A.diagonal() << 1.0, s;
    return pseudo_inverse(A, {}).inverse;
  };
  EXPECT_NEAR(gain(0.0200001)(1, 1), gain(0.0199999)(1, 1), 0.01);
  EXPECT_NEAR(gain(0.001)(0, 0), 1.0, 1e-12);
  double fastest = 0.0;
  for (double s = 1e-4; s < 0.1; s += 1e-4) fastest = std::max(fastest, gain(s)(1, 1));
  EXPECT_LE(fastest, 1.0 / 0.02 + 1e-9)
      << "no direction is answered faster than where damping starts";
  EXPECT_LT(gain(0.001)(1, 1), 0.5);
}

class SolveRates : public ::testing::Test {
 protected:
  JointRates solve(const Arm& arm,
                   const JointVector& q,
                   const Eigen::MatrixXd& J,
                   const Eigen::VectorXd& wanted,
                   const std::vector<JointTask>& tasks = {}) {
    return solve_rates(arm, q, J, wanted, tasks, kCycle_s, {});
  }
  static constexpr double kCycle_s = 0.08;
  Random random_{7};
};

TEST_F(SolveRates, NeverTakesAJointPastItsRangeOrRate) {
  const Arm arm = puma_560(2.0);
  int clamped = 0;
  int slowed = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    JointVector q(6);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
      // Often on the limit itself.
      const double u = std::clamp(random_.uniform(-0.2, 1.2), 0.0, 1.0);
      q(i) = joint.min_rad + u * (joint.max_rad - joint.min_rad);
    }
    const Eigen::Index rows = 3 + static_cast<Eigen::Index>(random_.below(4));
    const Eigen::MatrixXd J = random_matrix(random_, rows, 6);
    JointTask task{{0, 1, 2, 3, 4, 5}, random_matrix(random_, 6, 1)};
    const JointRates result = solve(arm, q, J, 2.0 * random_matrix(random_, rows, 1), {task});
    clamped += result.at_limit.empty() ? 0 : 1;
    slowed += result.scale < 1.0 ? 1 : 0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
      const double next = q(i) + result.rates(i) * kCycle_s;
      ASSERT_LE(next, joint.max_rad + 1e-9);
      ASSERT_GE(next, joint.min_rad - 1e-9);
      ASSERT_LE(std::abs(result.rates(i)), 2.0 + 1e-9);
    }
  }
  EXPECT_GT(clamped, 500);
  EXPECT_GT(slowed, 200);
}

TEST_F(SolveRates, LetsTheOtherJointsDoWhatAClampedOneCannot) {
  // Two joints push the same way; the first is at its limit.
  Arm arm;
  arm.joints.assign(2, ArmJoint{.min_rad = -1.0, .max_rad = 1.0, .max_rate_rad_s = 10.0});
  const Eigen::MatrixXd J = Eigen::MatrixXd::Ones(1, 2);
  const Eigen::VectorXd wanted = Eigen::VectorXd::Ones(1);
  const JointRates result = solve(arm, Eigen::Vector2d(1.0, 0.0), J, wanted);
  EXPECT_NEAR(result.rates(0), 0.0, 1e-12);
  EXPECT_NEAR(result.rates(1), 1.0, 1e-12);
  EXPECT_EQ(result.at_limit, std::vector<Eigen::Index>{0});
  EXPECT_EQ(result.rank, 1);
}

TEST_F(SolveRates, LeadsAJointBackThatIsPastItsLimit) {
  Arm arm;
  arm.joints.assign(2, ArmJoint{.min_rad = -1.0, .max_rad = 1.0, .max_rate_rad_s = 10.0});
  const Eigen::MatrixXd J = Eigen::MatrixXd::Identity(1, 2);
  const JointRates result = solve(arm, Eigen::Vector2d(1.1, 0.0), J, Eigen::VectorXd::Ones(1));
  EXPECT_NEAR(1.1 + result.rates(0) * kCycle_s, 1.0, 1e-12);
}

TEST_F(SolveRates, KeepsTheDirectionWhenItSlowsDown) {
  const Arm arm = puma_560(0.5);
  const Eigen::MatrixXd J = Eigen::MatrixXd::Identity(6, 6);
  JointVector wanted(6);
  wanted << 2.0, -1.0, 0.5, 0.0, 0.1, -0.2;
  const JointRates result = solve(arm, testing::puma_560_pose() * 0.5, J, wanted);
  EXPECT_NEAR(result.scale, 0.25, 1e-12);
  EXPECT_LT((result.rates - 0.25 * wanted).norm(), 1e-12);
}

TEST_F(SolveRates, ServesJointTasksInTheirOrderAndNeverAgainstTheMainTask) {
  const Arm arm = puma_560(100.0);
  const JointVector q = testing::puma_560_pose() * 0.5;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::MatrixXd J = random_matrix(random_, 3, 6);
    const Eigen::VectorXd wanted = 0.1 * random_matrix(random_, 3, 1);
    const JointTask first{{0}, JointVector::Unit(6, 0)};
    const JointTask against{{0}, -5.0 * JointVector::Unit(6, 0)};
    const JointTask elsewhere{{3}, JointVector::Unit(6, 3)};
    const JointRates alone = solve(arm, q, J, wanted, {first});
    const JointRates both = solve(arm, q, J, wanted, {first, against, elsewhere});
    EXPECT_LT((J * both.rates - wanted).norm(), 1e-9);
    EXPECT_NEAR(both.rates(0), alone.rates(0), 1e-9) << "what is less important gives way";
    EXPECT_GT(both.rates(3), alone.rates(3)) << "and acts where it can";
  }
}

TEST_F(SolveRates, GivesJointTasksNoRateThatWouldSlowTheMainTask) {
  const Arm arm = puma_560(1.0);
  const JointVector q = testing::puma_560_pose() * 0.5;
  const Eigen::MatrixXd J = Eigen::MatrixXd::Identity(3, 6);
  const Eigen::VectorXd wanted = 0.9 * Eigen::VectorXd::Ones(3);
  const JointRates result = solve(arm, q, J, wanted, {{{4}, 50.0 * JointVector::Unit(6, 4)}});
  EXPECT_EQ(result.scale, 1.0);
  EXPECT_NEAR(result.rates(4), 1.0, 1e-12);
  EXPECT_LT((J * result.rates - wanted).norm(), 1e-12);
}

}  // namespace
}  // namespace landmarkdb
