#include "bench/retrieval/logistic.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "tests/unit/bench/retrieval/synthetic_samples.hpp"

namespace landmarkdb::bench {

namespace {

using testing::HasSubstr;

// The gradient of the loss that fit_logistic minimises.
Eigen::VectorXd slope(const Samples& samples,
                      const Eigen::VectorXd& weights,
                      const LogisticOptions& options) {
  const Eigen::VectorXd p = predict(samples.features, weights);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(weights.size());
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const double count = samples.right[i] > 0.5 ? 1.0 : options.wrong_weight;
    slope += count * (p[i] - samples.right[i]) * samples.features.row(i).transpose();
  }
  slope.tail(slope.size() - 1) += options.ridge * weights.tail(weights.size() - 1);
  return slope;
}

TEST(FitLogistic, RecoversTheWeightsThatLabelsWereDrawnFrom) {
  const Eigen::Vector4d truth(-0.7, 2.0, -1.0, 0.0);
  const Samples samples = synthetic_samples(truth, 20'000, 10, 1);
  const Eigen::VectorXd weights = fit_logistic(samples.features, samples.right, {.ridge = 1e-6});
  EXPECT_LT((weights - truth).cwiseAbs().maxCoeff(), 0.08);  // three standard errors
}

TEST(FitLogistic, EndsWhereTheLossIsFlatInManyRandomProblems) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Samples samples = synthetic_samples(Eigen::Vector4d(0.3, 3.0, -6.0, 1.0), 60, 3, seed);
    const LogisticOptions options{.wrong_weight = seed % 2 == 0 ? 1.0 : 5.0};
    const Eigen::VectorXd weights = fit_logistic(samples.features, samples.right, options);
    EXPECT_LT(slope(samples, weights, options).cwiseAbs().maxCoeff(), 1e-6) << seed;
  }
}

TEST(FitLogistic, StaysFiniteWhereAFeatureTellsRightFromWrongByItself) {
  Eigen::MatrixXd features(4, 2);
  features << 1, -1000, 1, -999, 1, 999, 1, 1000;
  const Eigen::VectorXd weights = fit_logistic(features, Eigen::Vector4d(0, 0, 1, 1), {});
  EXPECT_TRUE(weights.allFinite());
  EXPECT_GT(weights[1], 0.0);
}

TEST(FitLogistic, CountsAWrongRowAsOftenAsItIsTold) {
  // With the constant alone the confidence is the share of right rows: 3 of 3 + 2 * 4.
  const Eigen::MatrixXd features = Eigen::MatrixXd::Ones(5, 1);
  Eigen::VectorXd right(5);
  right << 1, 1, 1, 0, 0;
  const Eigen::VectorXd weights = fit_logistic(features, right, {.wrong_weight = 4.0});
  EXPECT_NEAR(predict(features, weights)[0], 3.0 / 11.0, 1e-9);
}

TEST(FitLogistic, LeavesTheConstantOutOfTheRidge) {
  const Eigen::MatrixXd features = Eigen::MatrixXd::Ones(4, 1);
  const Eigen::VectorXd weights =
      fit_logistic(features, Eigen::Vector4d(1, 1, 1, 0), {.ridge = 1e6});
  EXPECT_NEAR(weights[0], std::log(3.0), 1e-9);
}

TEST(FitLogistic, RefusesASingleClass) {
  const Eigen::MatrixXd features = Eigen::MatrixXd::Ones(3, 1);
  EXPECT_THROW(fit_logistic(features, Eigen::Vector3d::Ones(), {}), Error);
  EXPECT_THROW(fit_logistic(features, Eigen::Vector3d::Zero(), {}), Error);
}

TEST(HeldOutConfidences, AreThoseOfAFitToTheOtherPlaces) {
  const Samples samples = synthetic_samples(Eigen::Vector3d(0.0, 2.0, -1.0), 90, 3, 7);
  const Eigen::VectorXd confidences = held_out_confidences(samples, {});
  std::vector<Eigen::Index> others;
  for (Eigen::Index i = 0; i < 90; ++i) {
    if (i % 3 != 1) others.push_back(i);
  }
  const Eigen::VectorXd weights =
      fit_logistic(samples.features(others, Eigen::all), samples.right(others), {});
  const Eigen::VectorXd expected = predict(samples.features, weights);
  for (Eigen::Index i = 1; i < 90; i += 3) EXPECT_DOUBLE_EQ(confidences[i], expected[i]);
}

TEST(HeldOutConfidences, DoNotChangeWhenTheLabelsOfTheirOwnPlaceDo) {
  Samples samples = synthetic_samples(Eigen::Vector3d(0.0, 2.0, -1.0), 120, 4, 3);
  const Eigen::VectorXd before = held_out_confidences(samples, {});
  for (Eigen::Index i = 2; i < 120; i += 4) samples.right[i] = 1.0 - samples.right[i];
  const Eigen::VectorXd after = held_out_confidences(samples, {});
  for (Eigen::Index i = 0; i < 120; ++i) {
    if (i % 4 == 2) {
      EXPECT_EQ(before[i], after[i]) << i;
    } else {
      EXPECT_NE(before[i], after[i]) << i;
    }
  }
}

TEST(HeldOutConfidences, NameThePlaceWithoutWhichOneClassIsLeft) {
  Samples samples = synthetic_samples(Eigen::Vector2d(0.0, 1.0), 6, 2, 1);
  samples.right << 1, 1, 0, 1, 1, 1;  // the wrong one is in place 0
  try {
    held_out_confidences(samples, {});
    FAIL() << "went through";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), HasSubstr("without f 0: all rows are right"));
  }
}

}  // namespace

}  // namespace landmarkdb::bench
