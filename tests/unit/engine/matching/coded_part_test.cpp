#include "engine/matching/coded_part.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/matching/make_codes.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kRows = 300;

DescriptorCodes some_codes() { return make_codes(testing::random_descriptors(kRows, 5, 1), {}); }

// What lies packed at a place, as it was before.
std::vector<std::int8_t> code_at(const PackedCodes& packed, std::size_t place) {
  const std::uint8_t* group = packed.bytes.data() + place / kCodeGroup * kCodeGroup * kCodeLength;
  std::vector<std::int8_t> code;
  for (std::size_t j = 0; j < kCodeLength; ++j) {
    const std::size_t at = (j / 4 * kCodeGroup + place % kCodeGroup) * 4 + j % 4;
    code.push_back(static_cast<std::int8_t>(group[at] - 128));
  }
  return code;
}

TEST(CodedPart, HoldsEachRowOnceWithItsCodeInItsList) {
  const DescriptorCodes codes = some_codes();
  const auto part = make_coded_part(codes, kRows);
  EXPECT_EQ(part->rows, kRows);
  ASSERT_EQ(part->lists(), codes.lists());
  EXPECT_EQ(part->centres, codes.centres);
  EXPECT_EQ(part->list_start.back(), part->codes.groups());
  std::size_t found = 0;
  for (std::size_t l = 0; l < codes.lists(); ++l) {
    const std::size_t first = part->list_start[l] * kCodeGroup;
    const std::size_t count = codes.list_start[l + 1] - codes.list_start[l];
    for (std::size_t i = 0; i < count; ++i, ++found) {
      const std::size_t place = codes.list_start[l] + i;
      ASSERT_EQ(part->row_of[first + i], codes.rows[place]);
      const auto want = codes.codes.begin() + static_cast<std::ptrdiff_t>(place * kCodeLength);
      EXPECT_TRUE(std::equal(want, want + kCodeLength, code_at(part->codes, first + i).begin()));
    }
    for (std::size_t i = first + count; i < part->list_start[l + 1] * kCodeGroup; ++i) {
      EXPECT_EQ(part->row_of[i], CodedPart::kNoRow);
      EXPECT_EQ(part->codes.bias[i], PackedCodes::kNoCode);
    }
  }
  EXPECT_EQ(found, kRows);
}

TEST(CodedPart, LeavesListsWithoutRowsOut) {
  DescriptorCodes codes = some_codes();
  codes.list_start.insert(codes.list_start.begin() + 1, codes.list_start[1]);
  codes.centres.insert(codes.centres.begin() + kCodeLength, kCodeLength, std::int8_t{9});
  ASSERT_TRUE(fault_of_codes(codes, kRows).empty());
  const auto part = make_coded_part(codes, kRows);
  EXPECT_EQ(part->lists(), codes.lists() - 1);
  EXPECT_EQ(part->centres, some_codes().centres);
  EXPECT_EQ(make_coded_part({}, 0)->lists(), 0U);
}

TEST(CodedPart, RefusesCodesThatDoNotFit) {
  DescriptorCodes codes = some_codes();
  EXPECT_THROW(make_coded_part(codes, kRows - 1), Error);
  codes.rows[7] = 99'999;
  EXPECT_THROW(make_coded_part(codes, kRows), Error);
}

TEST(TailsByRow, PutsEachTailWhereItsRowIs) {
  const DescriptorCodes codes = some_codes();
  const std::vector<std::int8_t> tails = tails_by_row(codes);
  ASSERT_EQ(tails.size(), kRows * kCodeLength);
  for (std::size_t place = 0; place < kRows; ++place) {
    const auto want = codes.tails.begin() + static_cast<std::ptrdiff_t>(place * kCodeLength);
    const std::size_t at = codes.rows[place] * kCodeLength;
    EXPECT_TRUE(
        std::equal(want, want + kCodeLength, tails.begin() + static_cast<std::ptrdiff_t>(at)));
  }
}

}  // namespace
}  // namespace landmarkdb
