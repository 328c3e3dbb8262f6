#include "engine/matching/measures.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

constexpr std::array kAll = {Measure::kL2,
                             Measure::kL1,
                             Measure::kChi2,
                             Measure::kIntersection,
                             Measure::kCorrelation,
                             Measure::kBhattacharyya};

// The three cases of the paper's Table 1, on two bins.
struct TableRow {
  Measure measure;
  double exact, half, miss;
};

class Table : public ::testing::TestWithParam<TableRow> {};

TEST_P(Table, GivesTheEndsForAnExactMatchAndATotalMismatch) {
  const std::vector<float> one = {1.0F, 0.0F};
  const std::vector<float> other = {0.0F, 1.0F};
  EXPECT_NEAR(measure(GetParam().measure, one, one), GetParam().exact, 1e-6);
  EXPECT_NEAR(measure(GetParam().measure, one, other), GetParam().miss, 1e-6);
}

TEST_P(Table, GivesWhatLiesBetweenForAHalfMatch) {
  const std::vector<float> one = {1.0F, 0.0F};
  const std::vector<float> even = {0.5F, 0.5F};
  EXPECT_NEAR(measure(GetParam().measure, one, even), GetParam().half, 1e-6);
}

// Half matches: correlation with a constant histogram counts that as the zero vector, 1 - 1/2;
// chi2 .5^2/1.5 + .5^2/.5 = 2/3; l2 sqrt((2 - sqrt 2) / 2); bhattacharyya sqrt(1 - sqrt(1/2)).
INSTANTIATE_TEST_SUITE_P(
    Measures,
    Table,
    ::testing::Values(TableRow{Measure::kCorrelation, 1.0, 0.5, -1.0},
                      TableRow{Measure::kChi2, 0.0, 2.0 / 3.0, 2.0},
                      TableRow{Measure::kIntersection, 1.0, 0.5, 0.0},
                      TableRow{Measure::kL1, 0.0, 0.5, 1.0},
                      TableRow{Measure::kL2, 0.0, 0.541196100146197, 1.0},
                      TableRow{Measure::kBhattacharyya, 0.0, 0.541196100146197, 1.0}));

std::vector<float> random_histogram(Random& random, std::size_t bins) {
  std::vector<float> h(bins);
  for (float& v : h) v = random.uniform() < 0.3 ? 0.0F : static_cast<float>(random.uniform());
  return h;
}

TEST(Measure, IsSymmetricAndWithinTheTablesBounds) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const std::vector<float> a = random_histogram(random, 352);
    const std::vector<float> b = random_histogram(random, 352);
    for (const Measure which : kAll) {
      const double value = measure(which, a, b);
      EXPECT_EQ(value, measure(which, b, a));
      EXPECT_GE(value, which == Measure::kCorrelation ? -1.0 - 1e-6 : -1e-6);
      EXPECT_LE(value, which == Measure::kChi2 ? 2.0 + 1e-6 : 1.0 + 1e-6);
    }
  }
}

TEST(Measure, DoesNotDependOnTheHistogramsScale) {
  Random random(2);
  const std::vector<float> a = random_histogram(random, 64);
  const std::vector<float> b = random_histogram(random, 64);
  std::vector<float> b_large = b;
  for (float& v : b_large) v *= 1024.0F;
  for (const Measure which : kAll) {
    EXPECT_NEAR(measure(which, a, b), measure(which, a, b_large), 1e-6);
  }
}

TEST(Measure, EqualsTheTextbookFormulas) {
  const std::vector<float> a = {0.1F, 0.2F, 0.3F, 0.4F};
  const std::vector<float> b = {0.4F, 0.4F, 0.1F, 0.1F};
  // a has mean .25 and deviations -.15 -.05 .05 .15, b has .15 .15 -.15 -.15.
  EXPECT_NEAR(measure(Measure::kCorrelation, a, b), -0.06 / std::sqrt(0.05 * 0.09), 1e-6);
  EXPECT_NEAR(
      measure(Measure::kChi2, a, b), 0.09 / 0.5 + 0.04 / 0.6 + 0.04 / 0.4 + 0.09 / 0.5, 1e-6);
  EXPECT_NEAR(measure(Measure::kIntersection, a, b), 0.5, 1e-6);
  EXPECT_NEAR(measure(Measure::kL1, a, b), 0.5, 1e-6);
  const double product = 0.04 + 0.08 + 0.03 + 0.04;
  EXPECT_NEAR(measure(Measure::kL2, a, b), std::sqrt(1.0 - product / std::sqrt(0.30 * 0.34)), 1e-6);
  EXPECT_NEAR(measure(Measure::kBhattacharyya, a, b),
              std::sqrt(1.0 - (std::sqrt(0.04) + std::sqrt(0.08) + std::sqrt(0.03) + 0.2)),
              1e-6);
}

TEST(Measure, TakesHistogramsWithoutContent) {
  const std::vector<float> nothing(352, 0.0F);
  std::vector<float> something(352, 0.0F);
  something[7] = 2.0F;
  for (const Measure which : kAll) {
    for (const std::vector<float>& a : {nothing, something}) {
      EXPECT_TRUE(std::isfinite(measure(which, nothing, a)));
      EXPECT_TRUE(std::isfinite(dissimilarity(which, a, nothing)));
    }
  }
  EXPECT_EQ(measure(Measure::kChi2, nothing, nothing), 0.0);
  EXPECT_EQ(measure(Measure::kIntersection, nothing, something), 0.0);
  EXPECT_TRUE(std::isfinite(measure(Measure::kL2, {}, {})));
  // A constant histogram has no deviation that rounding could be scaled up from.
  const std::vector<float> level(352, 0.1F);
  EXPECT_NEAR(measure(Measure::kCorrelation, level, something), 0.5, 1e-6);
}

TEST(Dissimilarity, IsZeroForTheSameAndTheMeasuresOwnValueTurnedRightWayUp) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const std::vector<float> a = random_histogram(random, 352);
    const std::vector<float> b = random_histogram(random, 352);
    for (const Measure which : kAll) {
      EXPECT_NEAR(dissimilarity(which, a, a), 0.0, 1e-6);
      const double d = static_cast<double>(dissimilarity(which, a, b));
      EXPECT_GT(d, 0.0);
      EXPECT_NEAR(measure_of_dissimilarity(which, d), measure(which, a, b), 2e-6);
    }
  }
}

TEST(Measure, RefusesHistogramsOfTwoLengths) {
  const std::vector<float> a(3, 1.0F);
  const std::vector<float> b(4, 1.0F);
  EXPECT_THROW(measure(Measure::kL2, a, b), Error);
  EXPECT_THROW(dissimilarity(Measure::kChi2, a, b), Error);
}

}  // namespace
}  // namespace landmarkdb
