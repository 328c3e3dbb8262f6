#include "engine/base/random.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(Random, DrawsWhatThePublishedGeneratorDraws) {
  // SplitMix64's first outputs for seed 1234567, as its reference implementation prints them.
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
  EXPECT_EQ(random.next(), 9817491932198370423ULL);
  EXPECT_EQ(random.next(), 4593380528125082431ULL);
  EXPECT_EQ(random.next(), 16408922859458223821ULL);
}

TEST(Random, RepeatsForASeedAndDiffersForAnother) {
  Random a(7), b(7), c(8);
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t draw = a.next();
    EXPECT_EQ(draw, b.next());
    EXPECT_NE(draw, c.next());
  }
}

TEST(Random, IsUniformFromZeroToOneAndNeverOne) {
  Random random(3);
  std::array<int, 10> counts{};
  double sum = 0.0, squares = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += u * u;
    ++counts[static_cast<std::size_t>(10.0 * u)];
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.005);
  EXPECT_NEAR(squares / kDraws, 1.0 / 3.0, 0.005);
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 10, 500);  // five standard deviations
}

TEST(Random, KeepsToTheRangeAsked) {
  Random random(4);
  for (int i = 0; i < 10'000; ++i) {
    const double v = random.uniform(-3.0, -1.0);
    EXPECT_GE(v, -3.0);
    EXPECT_LT(v, -1.0);
    EXPECT_LT(random.below(7), 7U);
    EXPECT_EQ(random.below(1), 0U);
  }
}

TEST(Random, DrawsEachOfNEquallyOften) {
  Random random(5);
  std::array<int, 7> counts{};
  for (int i = 0; i < 70'000; ++i) ++counts[random.below(7)];
  for (const int count : counts) EXPECT_NEAR(count, 10'000, 500);
}

TEST(Random, HasTheMomentsOfTheNormalDistribution) {
  Random random(6);
  double sum = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    cubes += x * x * x;
    fourths += x * x * x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.02);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.03);
  EXPECT_NEAR(cubes / kDraws, 0.0, 0.07);
  EXPECT_NEAR(fourths / kDraws, 3.0, 0.2);
}

}  // namespace
}  // namespace landmarkdb
