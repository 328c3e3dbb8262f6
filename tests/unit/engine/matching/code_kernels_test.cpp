#include "engine/matching/code_kernels.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using Codes = std::vector<std::int8_t>;

// Whole range, with the largest numbers in plenty: sums must not overflow.
Codes random_codes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Codes codes(count * kCodeLength);
  for (std::int8_t& c : codes) {
    const int value = static_cast<int>(random.below(255)) - 127;
    c = static_cast<std::int8_t>(random.uniform() < 0.3 ? (value < 0 ? -127 : 127) : value);
  }
  return codes;
}

std::int32_t squared_distance(const std::int8_t* a, const std::int8_t* b) {
  std::int32_t sum = 0;
  for (std::size_t j = 0; j < kCodeLength; ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return sum;
}

std::vector<const CodeKernels*> all_kernels() {
  std::vector<const CodeKernels*> kernels;
  for (const char* name : {"baseline", "avx2", "avx512vnni"}) {
    if (const CodeKernels* k = code_kernels(name)) kernels.push_back(k);
  }
  return kernels;
}

// The score is the squared distance turned round, but for what is the query's alone.
TEST(CodeKernels, ScoreFallsByTheSquaredDistanceOnEveryInstructionSet) {
  const Codes stored = random_codes(37, 1);
  const Codes queries = random_codes(5, 2);
  PackedCodes packed;
  packed.append(stored);
  ASSERT_EQ(packed.groups(), 3U);
  for (const CodeKernels* kernels : all_kernels()) {
    for (std::size_t q = 0; q < 5; ++q) {
      const std::int8_t* query = queries.data() + q * kCodeLength;
      std::vector<std::int32_t> scores(packed.bias.size());
      kernels->scores(
          query, packed.bytes.data(), packed.bias.data(), packed.groups(), scores.data());
      const std::int32_t of_query = scores[0] + squared_distance(query, stored.data());
      for (std::size_t i = 0; i < 37; ++i) {
        const std::int8_t* code = stored.data() + i * kCodeLength;
        EXPECT_EQ(of_query - scores[i], squared_distance(query, code));
        EXPECT_EQ(kernels->squared_distance(query, code), squared_distance(query, code));
      }
    }
  }
}

TEST(CodeKernels, FindThoseAboveAFloorInTheirOrder) {
  const Codes stored = random_codes(100, 3);
  const Codes query = random_codes(1, 4);
  PackedCodes packed;
  packed.append(stored);
  for (const CodeKernels* kernels : all_kernels()) {
    std::vector<std::int32_t> scores(packed.bias.size());
    kernels->scores(
        query.data(), packed.bytes.data(), packed.bias.data(), packed.groups(), scores.data());
    const std::int32_t floor = scores[41];
    CodeHits hits;
    hits.make_room(packed.bias.size());
    const std::size_t found = kernels->above(query.data(),
                                             packed.bytes.data(),
                                             packed.bias.data(),
                                             packed.groups(),
                                             floor,
                                             hits.scores.data(),
                                             hits.places.data());
    std::size_t next = 0;
    for (std::uint32_t i = 0; i < 100; ++i) {
      if (scores[i] <= floor) continue;
      ASSERT_LT(next, found);
      EXPECT_EQ(hits.places[next], i);
      EXPECT_EQ(hits.scores[next++], scores[i]);
    }
    EXPECT_EQ(next, found);
  }
}

TEST(CodeKernels, ProjectToWholeNumbersAlikeOnEveryInstructionSet) {
  Random random(5);
  std::vector<std::int16_t> row(kShotLength);
  std::vector<std::int16_t> components(3 * kShotLength);
  for (std::int16_t& v : row) v = static_cast<std::int16_t>(random.below(8193));
  for (std::int16_t& v : components) v = static_cast<std::int16_t>(random.below(255)) - 127;
  std::vector<std::int32_t> want(3);
  for (std::size_t j = 0; j < components.size(); ++j) {
    want[j / kShotLength] += row[j % kShotLength] * components[j];
  }
  for (const CodeKernels* kernels : all_kernels()) {
    std::vector<std::int32_t> sums(3);
    kernels->project(row.data(), components.data(), 3, sums.data());
    EXPECT_EQ(sums, want);
  }
}

TEST(PackedCodes, BeginEachListInAGroupOfItsOwn) {
  PackedCodes packed;
  packed.append(random_codes(3, 6));
  packed.append(random_codes(17, 7));
  EXPECT_EQ(packed.groups(), 3U);
  EXPECT_EQ(packed.bias[3], PackedCodes::kNoCode);
  EXPECT_NE(packed.bias[16], PackedCodes::kNoCode);
  EXPECT_EQ(packed.bias[33], PackedCodes::kNoCode);
}

TEST(CodeKernels, KnowNoOtherInstructionSet) { EXPECT_EQ(code_kernels("mmx"), nullptr); }

}  // namespace
}  // namespace landmarkdb
