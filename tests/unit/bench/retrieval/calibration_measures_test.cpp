#include "bench/retrieval/calibration_measures.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb::bench {

namespace {

using Eigen::Vector4d;

TEST(MeanLogLoss, IsTheMeanOfTheLogsOfWhatCameTrue) {
  const double expected = -(std::log(0.9) + std::log(0.8) + std::log(0.5) + std::log(0.4)) / 4.0;
  EXPECT_NEAR(mean_log_loss(Vector4d(0.9, 0.2, 0.5, 0.4), Vector4d(1, 0, 0, 1)), expected, 1e-12);
}

TEST(MeanLogLoss, IsFiniteForACertaintyThatWasWrong) {
  EXPECT_NEAR(mean_log_loss(Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(1, 1)),
              -std::log(1e-12) / 2.0,
              1e-9);
}

TEST(AreaUnderRoc, CountsThePairsInOrder) {
  // Right 0.9 and 0.4, wrong 0.5 and 0.1: all pairs but (0.4, 0.5) are in order.
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.9, 0.5, 0.4, 0.1), Vector4d(1, 0, 1, 0)), 0.75);
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.9, 0.8, 0.4, 0.1), Vector4d(1, 1, 0, 0)), 1.0);
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.9, 0.8, 0.4, 0.1), Vector4d(0, 0, 1, 1)), 0.0);
}

TEST(AreaUnderRoc, CountsEqualConfidencesHalf) {
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.5, 0.5, 0.5, 0.5), Vector4d(1, 0, 1, 0)), 0.5);
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.9, 0.5, 0.5, 0.1), Vector4d(1, 1, 0, 0)), 0.875);
}

TEST(AreaUnderRoc, IsAHalfForASingleClass) {
  EXPECT_DOUBLE_EQ(area_under_roc(Vector4d(0.9, 0.5, 0.4, 0.1), Vector4d::Ones()), 0.5);
}

TEST(AreaUnderRoc, AgreesWithCountingAllPairs) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    Eigen::VectorXd confidences(30);
    Eigen::VectorXd right(30);
    for (Eigen::Index i = 0; i < 30; ++i) {
      confidences[i] = static_cast<double>(random.below(10)) / 10.0;  // so that some are equal
      right[i] = static_cast<double>(i < 3 ? i % 2 : static_cast<Eigen::Index>(random.below(2)));
    }
    double above = 0.0;
    double pairs = 0.0;
    for (Eigen::Index i = 0; i < 30; ++i) {
      for (Eigen::Index k = 0; k < 30; ++k) {
        if (right[i] < 0.5 || right[k] > 0.5) continue;
        pairs += 1.0;
        if (confidences[i] > confidences[k]) above += 1.0;
        if (confidences[i] == confidences[k]) above += 0.5;
      }
    }
    EXPECT_NEAR(area_under_roc(confidences, right), above / pairs, 1e-12);
  }
}

TEST(AcceptedAt, TakesTheThresholdItselfIn) {
  const Accepted accepted = accepted_at(0.5, Vector4d(0.5, 0.49, 0.9, 0.7), Vector4d(1, 1, 0, 1));
  EXPECT_EQ(accepted.right, 2U);
  EXPECT_EQ(accepted.wrong, 1U);
}

// Newcombe, Two-sided confidence intervals for the single proportion, 1998, table I, method 3.
TEST(WilsonInterval, IsThatOfThePublishedExamples) {
  constexpr double kNinetyFivePercent = 1.959963984540054;
  const struct {
    std::size_t successes, count;
    double low, high;
  } published[] = {{81, 263, 0.2553, 0.3662},
                   {15, 148, 0.0624, 0.1605},
                   {0, 20, 0.0, 0.1611},
                   {1, 29, 0.0061, 0.1718}};
  for (const auto& one : published) {
    const Interval interval = wilson_interval(one.successes, one.count, kNinetyFivePercent);
    EXPECT_NEAR(interval.low, one.low, 5e-5);
    EXPECT_NEAR(interval.high, one.high, 5e-5);
  }
}

TEST(WilsonInterval, IsOfNinetyPercentUnlessToldOtherwise) {
  // The end of none of n is z^2 / (n + z^2).
  const double z2 = 1.6448536269514722 * 1.6448536269514722;
  EXPECT_DOUBLE_EQ(wilson_interval(0, 10).low, 0.0);
  EXPECT_NEAR(wilson_interval(0, 10).high, z2 / (10.0 + z2), 1e-12);
  EXPECT_DOUBLE_EQ(wilson_interval(10, 10).high, 1.0);
  EXPECT_NEAR(wilson_interval(10, 10).low, 10.0 / (10.0 + z2), 1e-12);
}

TEST(WilsonInterval, IsEverythingWhenNothingWasCounted) {
  EXPECT_DOUBLE_EQ(wilson_interval(0, 0).low, 0.0);
  EXPECT_DOUBLE_EQ(wilson_interval(0, 0).high, 1.0);
}

TEST(Reliability, PutsEachRowInItsBin) {
  Eigen::VectorXd confidences(5);
  Eigen::VectorXd right(5);
  confidences << 0.0, 0.09, 0.1, 0.95, 1.0;
  right << 0, 1, 0, 1, 1;
  const auto bins = reliability(confidences, right);
  ASSERT_EQ(bins.size(), 10U);
  EXPECT_EQ(bins[0].count, 2U);
  EXPECT_EQ(bins[0].right, 1U);
  EXPECT_NEAR(bins[0].mean_confidence, 0.045, 1e-12);
  EXPECT_DOUBLE_EQ(bins[0].share_right(), 0.5);
  EXPECT_EQ(bins[1].count, 1U);
  EXPECT_EQ(bins[9].count, 2U);
  EXPECT_NEAR(bins[9].mean_confidence, 0.975, 1e-12);
  EXPECT_DOUBLE_EQ(bins[9].interval.low, wilson_interval(2, 2).low);
  for (std::size_t i = 2; i < 9; ++i) EXPECT_EQ(bins[i].count, 0U) << i;
}

}  // namespace

}  // namespace landmarkdb::bench
