#include "engine/matching/code_bytes.hpp"

#include <gtest/gtest.h>

#include "engine/matching/make_codes.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kRows = 150;

TEST(CodeBytes, GiveTheCodesBack) {
  for (const std::size_t rows : {std::size_t{0}, kRows}) {
    const std::vector<float> values = testing::random_descriptors(rows, 4, 1);
    const DescriptorCodes codes = make_codes(values, {});
    const std::optional<DescriptorCodes> read = codes_from(make_scene_index(values, {}), rows);
    ASSERT_TRUE(read) << rows;
    EXPECT_EQ(read->centres, codes.centres);
    EXPECT_EQ(read->list_start, codes.list_start);
    EXPECT_EQ(read->rows, codes.rows);
    EXPECT_EQ(read->codes, codes.codes);
    EXPECT_EQ(read->tails, codes.tails);
  }
}

TEST(CodeBytes, AreNothingWhenTheyDoNotFit) {
  const SceneIndexBlob good = make_scene_index(testing::random_descriptors(kRows, 4, 2), {});
  EXPECT_FALSE(codes_from(good, kRows - 1));
  SceneIndexBlob other = good;
  other.version = 2;
  EXPECT_FALSE(codes_from(other, kRows));
  other = good;
  other.params += "!";
  EXPECT_FALSE(codes_from(other, kRows));
  for (std::size_t cut = 0; cut < good.codes.size(); cut += 997) {
    other = good;
    other.codes.resize(cut);
    EXPECT_FALSE(codes_from(other, kRows)) << cut;
  }
  other = good;
  other.codes.push_back({});
  EXPECT_FALSE(codes_from(other, kRows));
  other = good;
  for (std::size_t i = 4; i < 8; ++i) other.codes[i] = std::byte{255};  // four billion lists
  EXPECT_FALSE(codes_from(other, kRows));
}

}  // namespace
}  // namespace landmarkdb
