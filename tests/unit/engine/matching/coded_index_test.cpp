#include "engine/matching/coded_index.hpp"

#include <algorithm>
#include <cmath>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/matching/code_basis.hpp"
#include "engine/matching/make_codes.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

using testing::random_descriptors;

// Rows that vary as SHOT does, mostly along the first of its components, in clusters with noise.
// Uniform noise would be spread over all 352 bins alike, and no short code could tell it apart.
std::vector<float> surface_like_descriptors(std::size_t rows,
                                            std::size_t clusters,
                                            std::uint64_t seed) {
  const CodeBasis& basis = code_basis();
  Random random(seed);
  const auto add_components = [&](float* row, double size) {
    for (std::size_t d = 0; d < kCodeComponents; ++d) {
      const double along = size * random.normal() / std::sqrt(1.0 + static_cast<double>(d));
      for (std::size_t j = 0; j < kShotLength; ++j) {
        row[j] += static_cast<float>(along * basis.components[d * kShotLength + j]);
      }
    }
  };
  std::vector<float> centres(clusters * kShotLength, 0.05F);
  for (std::size_t c = 0; c < clusters; ++c) add_components(&centres[c * kShotLength], 1e-3);
  std::vector<float> values;
  for (std::size_t i = 0; i < rows; ++i) {
    const auto centre =
        centres.begin() + static_cast<std::ptrdiff_t>(random.below(clusters) * kShotLength);
    std::vector<float> row(centre, centre + kShotLength);
    add_components(row.data(), 5e-4);
    double squared = 0.0;
    for (float& v : row) {
      v = std::max(v, 0.0F);
      squared += static_cast<double>(v) * static_cast<double>(v);
    }
    for (float& v : row) v /= static_cast<float>(std::sqrt(squared));
    values.insert(values.end(), row.begin(), row.end());
  }
  return values;
}

// Parts of the given sizes, cut from `values`.
struct Parts {
  std::vector<std::vector<std::int8_t>> tails;
  std::vector<IndexedPart> parts;
};

Parts parts_of(const std::vector<float>& values, const std::vector<std::size_t>& sizes) {
  Parts result;
  std::size_t first = 0;
  result.tails.reserve(sizes.size());
  for (const std::size_t size : sizes) {
    const auto part = std::span(values).subspan(first * kShotLength, size * kShotLength);
    const DescriptorCodes codes = make_codes(part, {});
    result.tails.push_back(tails_by_row(codes));
    result.parts.push_back({part, make_coded_part(codes, size), result.tails.back()});
    first += size;
  }
  return result;
}

std::vector<DescriptorMatch> search(const DescriptorIndex& index,
                                    const std::vector<float>& queries,
                                    std::size_t k,
                                    int threads = 1) {
  RunContext context;
  context.threads = threads;
  std::vector<DescriptorMatch> found;
  index.search(queries, k, found, context);
  return found;
}

double recall(const std::vector<DescriptorMatch>& found,
              const std::vector<DescriptorMatch>& truth,
              std::size_t k) {
  std::size_t hits = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto row = truth.begin() + static_cast<std::ptrdiff_t>(i / k * k);
    hits += std::count_if(row,
                          row + static_cast<std::ptrdiff_t>(k),
                          [&](const DescriptorMatch& match) {
                            return match.index == found[i].index &&
                                   std::abs(match.distance - found[i].distance) < 1e-5F;
                          }) > 0
                ? 1U
                : 0U;
  }
  return static_cast<double>(hits) / static_cast<double>(truth.size());
}

// A match counts only with the exact index's row and distance.
TEST(CodedIndex, FindsNearlyAllThatTheExactIndexFinds) {
  std::vector<float> stored = surface_like_descriptors(6150, 300, 1);
  const std::vector<float> queries(stored.end() - 150 * kShotLength, stored.end());
  stored.resize(6000 * kShotLength);
  const Parts parts = parts_of(stored, {2500, 0, 3500});
  const auto index = make_coded_index(parts.parts);
  EXPECT_EQ(index->size(), 6000U);
  for (const std::size_t k : {1U, 7U}) {
    const auto truth = search(*make_exact_index(stored, Measure::kL2), queries, k);
    EXPECT_GE(recall(search(*index, queries, k), truth, k), 0.97) << k;
  }
}

TEST(CodedIndex, SearchesSomePartsAsAnIndexOfThemAloneThatReadsAllDoes) {
  const std::vector<float> stored = surface_like_descriptors(3000, 100, 8);
  const std::vector<float> queries = surface_like_descriptors(200, 100, 9);
  constexpr std::size_t kNeighbours = 7;
  Parts all = parts_of(stored, {800, 700, 0, 900, 600});
  for (IndexedPart& part : all.parts) part.values = {};  // by codes alone
  const std::vector<IndexedPart> some{all.parts[1], all.parts[3]};
  const auto want = search(
      *make_coded_index(some, {.list_share = 1.0, .refined = 32, .refined_a_neighbour = 2.0}),
      queries,
      kNeighbours);
  const auto index = make_coded_index(all.parts);
  for (const int threads : {1, 3}) {
    RunContext context;
    context.threads = threads;
    std::vector<DescriptorMatch> found;
    index->search_parts(std::vector<std::size_t>{1, 3}, queries, kNeighbours, found, context);
    ASSERT_EQ(found.size(), want.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].index, want[i].index + 800) << i;  // behind part 0; part 2 is empty
      EXPECT_EQ(found[i].distance, want[i].distance) << i;
    }
  }
}

TEST(CodedIndex, FindsMostWithoutTails) {
  std::vector<float> stored = surface_like_descriptors(6150, 300, 1);
  const std::vector<float> queries(stored.end() - 150 * kShotLength, stored.end());
  stored.resize(6000 * kShotLength);
  Parts parts = parts_of(stored, {2500, 3500});
  for (IndexedPart& part : parts.parts) {
    part.values = {};
    part.tails = {};
  }
  EXPECT_THROW(make_coded_index(parts.parts), Error);
  const auto index = make_coded_index(parts.parts, {.keeps_tails = false});
  EXPECT_FALSE(index->has_tails());
  constexpr std::size_t kNeighbours = 10;
  const auto found = search(*index, queries, kNeighbours);
  const auto truth = search(*make_exact_index(stored, Measure::kL2), queries, 1);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    hits += found[i].index == truth[i / kNeighbours].index ? 1U : 0U;
    const std::size_t before = i % kNeighbours > 0 ? i - 1 : i;
    EXPECT_LE(found[before].distance, found[i].distance);
  }
  EXPECT_GE(static_cast<double>(hits) / static_cast<double>(truth.size()), 0.95);
}

TEST(CodedIndex, FindsEachRowItself) {
  const std::vector<float> stored = random_descriptors(1000, 10, 2);
  const Parts parts = parts_of(stored, {1000});
  const auto found = search(*make_coded_index(parts.parts), stored, 1);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].index, i);
}

TEST(CodedIndex, GivesTheSameBytesForAnyThreadCountAndQuerySplit) {
  const std::vector<float> stored = random_descriptors(3000, 40, 3);
  const std::vector<float> queries = random_descriptors(1500, 40, 4);
  const Parts parts = parts_of(stored, {1000, 2000});
  const auto index = make_coded_index(parts.parts, {.list_share = 0.2, .min_lists = 5});
  const auto together = search(*index, queries, 5);
  EXPECT_EQ(search(*index, queries, 5, 3), together);
  std::vector<DescriptorMatch> alone;
  for (std::size_t i = 0; i < queries.size(); i += kShotLength) {
    const std::vector<float> one(queries.begin() + static_cast<std::ptrdiff_t>(i),
                                 queries.begin() + static_cast<std::ptrdiff_t>(i + kShotLength));
    const auto found = search(*index, one, 5);
    alone.insert(alone.end(), found.begin(), found.end());
  }
  EXPECT_EQ(alone, together);
}

TEST(CodedIndex, ReturnsTheLowerRowsOfManyAlike) {
  std::vector<float> stored;
  const std::vector<float> one = random_descriptors(1, 1, 5);
  for (int i = 0; i < 2000; ++i) stored.insert(stored.end(), one.begin(), one.end());
  const Parts parts = parts_of(stored, {2000});
  const auto found = search(*make_coded_index(parts.parts), one, 3);
  EXPECT_EQ(found[0].index, 0U);
  EXPECT_EQ(found[1].index, 1U);
  EXPECT_EQ(found[2].index, 2U);
}

TEST(CodedIndex, FillsUpWithNoMatchWhereItHoldsFewerThanK) {
  const std::vector<float> stored = random_descriptors(3, 3, 6);
  const Parts parts = parts_of(stored, {3});
  const auto found = search(*make_coded_index(parts.parts), stored, 5);
  ASSERT_EQ(found.size(), 15U);
  EXPECT_NE(found[2].index, DescriptorMatch::kNone);
  EXPECT_EQ(found[3], DescriptorMatch{});
  const auto none = search(*make_coded_index({}), stored, 2);
  EXPECT_EQ(none, std::vector<DescriptorMatch>(6));
}

TEST(CodedIndex, RefusesCodesThatDoNotFitAndQueriesThatAreNone) {
  const std::vector<float> stored = random_descriptors(100, 3, 7);
  Parts parts = parts_of(stored, {100});
  parts.parts[0].values = parts.parts[0].values.first(99 * kShotLength);
  EXPECT_THROW(make_coded_index(parts.parts), Error);
  const Parts good = parts_of(stored, {100});
  EXPECT_THROW(search(*make_coded_index(good.parts), {1.0F}, 1), Error);
  EXPECT_THROW(search(*make_coded_index(good.parts), std::vector<float>(kShotLength, -1.0F), 1),
               Error);
}

TEST(CodedIndex, StopsWhenAskedTo) {
  const std::vector<float> stored = random_descriptors(100, 3, 8);
  const Parts parts = parts_of(stored, {100});
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  std::vector<DescriptorMatch> found;
  EXPECT_THROW(make_coded_index(parts.parts)->search(stored, 1, found, context), Error);
}

}  // namespace
}  // namespace landmarkdb
