#include "engine/matching/descriptor_rows.hpp"

#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;

TEST(NormaliseRows, NormalisesEachRowByItself) {
  std::vector<float> values = testing::random_descriptors(3, 3, 1);
  for (std::size_t i = 0; i < kShotLength; ++i) values[kShotLength + i] *= 7.0F;
  const std::vector<float> rows = normalise_rows(values, Measure::kL1, "rows");
  ASSERT_EQ(rows.size(), values.size());
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = descriptor_row(rows, i);
    EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1.0, 1e-5);
  }
}

TEST(NormaliseRows, SaysWhatIsWrongWithWhich) {
  std::vector<float> values = testing::random_descriptors(2, 2, 2);
  values[kShotLength + 3] = -1.0F;
  try {
    normalise_rows(values, Measure::kL2, "query descriptors");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), HasSubstr("query descriptors: row 1"));
  }
  values.pop_back();
  try {
    normalise_rows(values, Measure::kL2, "query descriptors");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), HasSubstr("703 numbers, want a multiple of 352"));
  }
  EXPECT_TRUE(normalise_rows({}, Measure::kL2, "none").empty());
}

}  // namespace
}  // namespace landmarkdb
