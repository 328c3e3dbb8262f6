#include "engine/matching/make_codes.hpp"

#include <algorithm>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/matching/code_basis.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

using testing::random_descriptors;

TEST(CodeBasis, HoldsUnitVectorsThatStandAtRightAngles) {
  const CodeBasis& basis = code_basis();
  ASSERT_EQ(basis.components.size(), kCodeComponents * kShotLength);
  const auto product = [&](std::size_t a, std::size_t b) {
    double sum = 0.0;
    for (std::size_t j = 0; j < kShotLength; ++j) {
      sum += basis.components[a * kShotLength + j] * basis.components[b * kShotLength + j];
    }
    return sum;
  };
  const double squared = product(0, 0);
  for (std::size_t a = 0; a < kCodeComponents; ++a) {
    EXPECT_NEAR(product(a, a) / squared, 1.0, 0.02) << a;
    EXPECT_NEAR(product(a, (a + 1) % kCodeComponents) / squared, 0.0, 0.02) << a;
  }
}

TEST(MakeCodes, PutsEachRowIntoOneListWithItsOwnCodeAndTail) {
  const std::vector<float> values = random_descriptors(500, 9, 1);
  const DescriptorCodes codes = make_codes(values, {});
  const RowCodes rows = code_rows(values, {});
  EXPECT_EQ(fault_of_codes(codes, 500), "");
  EXPECT_GT(codes.lists(), 1U);
  for (std::size_t place = 0; place < 500; ++place) {
    const std::size_t row = codes.rows[place];
    for (std::size_t j = 0; j < kCodeLength; ++j) {
      ASSERT_EQ(codes.codes[place * kCodeLength + j], rows.codes[row * kCodeLength + j]);
      ASSERT_EQ(codes.tails[place * kCodeLength + j], rows.tails[row * kCodeLength + j]);
    }
  }
}

TEST(MakeCodesInOrder, HoldsTheSameCodesInTheOrderOfTheRows) {
  const std::vector<float> values = random_descriptors(5000, 9, 1);
  RunContext three;
  three.threads = 3;
  const DescriptorCodes codes = make_codes_in_order(values, three);
  const RowCodes rows = code_rows(values, {});
  EXPECT_EQ(fault_of_codes(codes, 5000), "");
  EXPECT_EQ(codes.codes, rows.codes);
  EXPECT_EQ(codes.tails, rows.tails);
  EXPECT_TRUE(std::is_sorted(codes.rows.begin(), codes.rows.end()));
  EXPECT_GT(codes.lists(), 1U);
  EXPECT_EQ(fault_of_codes(make_codes_in_order({}, {}), 0), "");
}

TEST(MakeCodes, KeepsWhatIsAlikeTogether) {
  // Eight clusters in a list each, or in a few: rows of one list are nearer than others.
  const std::vector<float> values = random_descriptors(512, 8, 2);
  const DescriptorCodes codes = make_codes(values, {});
  const auto squared = [&](std::size_t a, std::size_t b) {
    double sum = 0.0;
    for (std::size_t j = 0; j < kCodeLength; ++j) {
      const double d = codes.codes[a * kCodeLength + j] - codes.codes[b * kCodeLength + j];
      sum += d * d;
    }
    return sum;
  };
  double within = 0.0;
  double between = 0.0;
  const std::size_t lists = codes.lists();
  for (std::size_t l = 0; l < lists; ++l) {
    within += squared(codes.list_start[l], codes.list_start[l + 1] - 1);
    between += squared(codes.list_start[l], codes.list_start[(l + lists / 2) % lists]);
  }
  EXPECT_LT(within, between);
}

TEST(MakeCodes, GivesTheSameBytesForAnyThreadCount) {
  const std::vector<float> values = random_descriptors(700, 5, 3);
  RunContext three;
  three.threads = 3;
  const DescriptorCodes a = make_codes(values, {});
  const DescriptorCodes b = make_codes(values, three);
  EXPECT_EQ(a.centres, b.centres);
  EXPECT_EQ(a.list_start, b.list_start);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.codes, b.codes);
  EXPECT_EQ(a.tails, b.tails);
}

TEST(MakeCodes, TakesNothingOneRowAndRowsThatAreAllAlike) {
  EXPECT_EQ(fault_of_codes(make_codes({}, {}), 0), "");
  EXPECT_EQ(fault_of_codes(make_codes(random_descriptors(1, 1, 4), {}), 1), "");
  std::vector<float> same;
  const std::vector<float> one = random_descriptors(1, 1, 5);
  for (int i = 0; i < 300; ++i) same.insert(same.end(), one.begin(), one.end());
  EXPECT_EQ(fault_of_codes(make_codes(same, {}), 300), "");
}

TEST(MakeCodes, StopsWhenAskedTo) {
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_THROW(make_codes(random_descriptors(100, 2, 6), context), Error);
}

TEST(FaultOfCodes, TellsWhatDoesNotFit) {
  const DescriptorCodes good = make_codes(random_descriptors(200, 3, 7), {});
  EXPECT_NE(fault_of_codes(good, 199), "");
  EXPECT_NE(fault_of_codes({}, 1), "");
  DescriptorCodes bad = good;
  bad.rows[3] = bad.rows[4];
  EXPECT_THAT(fault_of_codes(bad, 200), ::testing::HasSubstr("once"));
  bad = good;
  bad.rows[3] = 4000;
  EXPECT_NE(fault_of_codes(bad, 200), "");
  bad = good;
  bad.list_start.back() = 201;
  EXPECT_NE(fault_of_codes(bad, 200), "");
  bad = good;
  std::swap(bad.list_start[0], bad.list_start[1]);
  EXPECT_NE(fault_of_codes(bad, 200), "");
  bad = good;
  std::swap(bad.list_start[1], bad.list_start[2]);
  EXPECT_THAT(fault_of_codes(bad, 200), ::testing::HasSubstr("overlap"));
  bad = good;
  bad.tails.pop_back();
  EXPECT_NE(fault_of_codes(bad, 200), "");
  bad = good;
  bad.centres.pop_back();
  EXPECT_NE(fault_of_codes(bad, 200), "");
}

}  // namespace
}  // namespace landmarkdb
