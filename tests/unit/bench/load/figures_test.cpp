#include "bench/load/figures.hpp"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::bench {
namespace {

std::vector<double> hundred_down_to_one() {
  std::vector<double> values(100);
  std::iota(values.rbegin(), values.rend(), 1.0);
  return values;
}

TEST(Quantile, IsTheValueOfThatRankWhateverTheOrder) {
  EXPECT_EQ(quantile(hundred_down_to_one(), 0.50), 50.0);
  EXPECT_EQ(quantile(hundred_down_to_one(), 0.95), 95.0);
  EXPECT_EQ(quantile(hundred_down_to_one(), 0.99), 99.0);
}

TEST(Quantile, IsAnEndAtTheEndsAndBeyond) {
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.0), 1.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 1.0), 3.0);
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 1.5), 3.0);
}

TEST(Quantile, OfFewNeverFlattersTheTail) { EXPECT_EQ(quantile({1.0, 9.0}, 0.95), 9.0); }

TEST(Quantile, OfNoneIsZero) { EXPECT_EQ(quantile({}, 0.5), 0.0); }

TEST(LoadFigures, CountEachOutcomeAndTimeTheAnswersAlone) {
  const std::vector<Request> requests = {{RequestOutcome::kAnswered, 10.0},
                                         {RequestOutcome::kRefused, 0.1},
                                         {RequestOutcome::kAnswered, 30.0},
                                         {RequestOutcome::kFailed, 5000.0},
                                         {RequestOutcome::kRefused, 0.2}};
  const LoadFigures figures = load_figures(requests, 4.0);
  EXPECT_EQ(figures.answered, 2U);
  EXPECT_EQ(figures.refused, 2U);
  EXPECT_EQ(figures.failed, 1U);
  EXPECT_DOUBLE_EQ(figures.per_second, 0.5);
  EXPECT_EQ(figures.p50_ms, 10.0);
  EXPECT_EQ(figures.p99_ms, 30.0);
}

TEST(LoadFigures, OfNothingAreZero) {
  const LoadFigures figures = load_figures({}, 0.0);
  EXPECT_EQ(figures.answered, 0U);
  EXPECT_EQ(figures.per_second, 0.0);
  EXPECT_EQ(figures.p95_ms, 0.0);
}

TEST(Fairness, IsHowMuchLongerTheLightClientsWait) {
  Fairness fairness;
  fairness.alone.p95_ms = 20.0;
  fairness.beside_heavy.p95_ms = 50.0;
  EXPECT_DOUBLE_EQ(fairness.p95_ratio(), 2.5);
  EXPECT_DOUBLE_EQ(to_json(fairness)["light_p95_ratio"].get<double>(), 2.5);
}

TEST(Fairness, HasNoRatioWithoutAnswers) { EXPECT_EQ(Fairness{}.p95_ratio(), 0.0); }

TEST(Growth, IsTheShareAddedBetweenTheFirstAndTheLast) {
  EXPECT_DOUBLE_EQ(growth({100.0, 500.0, 150.0}), 0.5);
  EXPECT_DOUBLE_EQ(growth({100.0, 50.0}), -0.5);
  EXPECT_EQ(growth({100.0}), 0.0);
  EXPECT_EQ(growth({}), 0.0);
}

}  // namespace
}  // namespace landmarkdb::bench
