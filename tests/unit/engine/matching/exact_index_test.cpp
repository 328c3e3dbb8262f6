#include <algorithm>
#include <array>
#include <limits>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/matching/measures.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

using testing::random_descriptors;

constexpr std::array kAll = {Measure::kL2,
                             Measure::kL1,
                             Measure::kChi2,
                             Measure::kIntersection,
                             Measure::kCorrelation,
                             Measure::kBhattacharyya};

std::span<const float> row(const std::vector<float>& values, std::size_t i) {
  return std::span(values).subspan(i * kShotLength, kShotLength);
}

// What search() promises, word for word: all distances, sorted.
std::vector<DescriptorMatch> by_definition(const std::vector<float>& stored,
                                           const std::vector<float>& queries,
                                           std::size_t k,
                                           Measure measure) {
  std::vector<DescriptorMatch> out;
  for (std::size_t q = 0; q < queries.size() / kShotLength; ++q) {
    std::vector<DescriptorMatch> all;
    for (std::size_t t = 0; t < stored.size() / kShotLength; ++t) {
      all.push_back(
          {static_cast<std::uint32_t>(t), dissimilarity(measure, row(queries, q), row(stored, t))});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
    });
    all.resize(k);
    out.insert(out.end(), all.begin(), all.end());
  }
  return out;
}

TEST(ExactIndex, FindsWhatTheDefinitionSaysForEveryMeasure) {
  const std::vector<float> stored = random_descriptors(331, 9, 1);
  const std::vector<float> queries = random_descriptors(13, 9, 1);
  for (const Measure measure : kAll) {
    std::vector<DescriptorMatch> found;
    make_exact_index(stored, measure)->search(queries, 5, found, {});
    EXPECT_EQ(found, by_definition(stored, queries, 5, measure))
        << "measure " << static_cast<int>(measure);
  }
}

TEST(ExactIndex, BreaksTiesByTheLowerIndexHoweverManyThereAre) {
  const std::vector<float> one = random_descriptors(1, 1, 2);
  std::vector<float> stored;
  for (int i = 0; i < 500; ++i) stored.insert(stored.end(), one.begin(), one.end());
  for (const Measure measure : kAll) {
    std::vector<DescriptorMatch> found;
    make_exact_index(stored, measure)->search(one, 3, found, {});
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].index, 0U);
    EXPECT_EQ(found[1].index, 1U);
    EXPECT_EQ(found[2].index, 2U);
    EXPECT_NEAR(found[2].distance, 0.0F, 1e-6F);
  }
}

// Far more queries than one block holds, and near-ties on purpose: all descriptors of a cluster are
// copies but for one bin.
TEST(ExactIndex, GivesTheSameBytesForAnyThreadCountAndQuerySplit) {
  std::vector<float> stored = random_descriptors(400, 3, 3);
  for (std::size_t i = 100; i < 400; ++i) {
    std::copy_n(row(stored, i % 100).begin(),
                kShotLength,
                stored.begin() + static_cast<std::ptrdiff_t>(i * kShotLength));
    stored[i * kShotLength + 5] += 1e-4F * static_cast<float>(i);
  }
  const std::vector<float> queries = random_descriptors(601, 3, 3);
  const auto index = make_exact_index(stored, Measure::kL2);
  RunContext three;
  three.threads = 3;
  std::vector<DescriptorMatch> all;
  std::vector<DescriptorMatch> threaded;
  index->search(queries, 4, all, {});
  index->search(queries, 4, threaded, three);
  EXPECT_EQ(all, threaded);
  for (std::size_t q = 0; q < 601; q += 75) {
    std::vector<DescriptorMatch> alone;
    index->search(row(queries, q), 4, alone, {});
    EXPECT_TRUE(
        std::equal(alone.begin(), alone.end(), all.begin() + static_cast<std::ptrdiff_t>(q * 4)));
  }
}

TEST(ExactIndex, SaysWhereAnIndexHoldsFewerThanAsked) {
  const std::vector<float> stored = random_descriptors(2, 2, 4);
  std::vector<DescriptorMatch> found;
  make_exact_index(stored, Measure::kL2)->search(stored, 4, found, {});
  ASSERT_EQ(found.size(), 8U);
  EXPECT_EQ(found[0].index, 0U);
  EXPECT_EQ(found[1].index, 1U);
  EXPECT_EQ(found[2], DescriptorMatch{});
  EXPECT_EQ(found[4].index, 1U);
  EXPECT_EQ(found[7].index, DescriptorMatch::kNone);
  make_exact_index({}, Measure::kChi2)->search(stored, 3, found, {});
  EXPECT_EQ(found, std::vector<DescriptorMatch>(6));
  make_exact_index(stored, Measure::kL1)->search({}, 3, found, {});
  EXPECT_TRUE(found.empty());
  make_exact_index(stored, Measure::kL1)->search(stored, 0, found, {});
  EXPECT_TRUE(found.empty());
}

TEST(ExactIndex, TakesDescriptorsWithoutContent) {
  std::vector<float> stored = random_descriptors(5, 5, 5);
  std::fill_n(stored.begin() + 2 * kShotLength, kShotLength, 0.0F);
  for (const Measure measure : kAll) {
    std::vector<DescriptorMatch> found;
    make_exact_index(stored, measure)->search(stored, 5, found, {});
    EXPECT_EQ(found, by_definition(stored, stored, 5, measure));
  }
}

TEST(ExactIndex, RefusesBrokenRows) {
  std::vector<float> values = random_descriptors(2, 2, 6);
  const auto index = make_exact_index(values, Measure::kL2);
  EXPECT_EQ(index->size(), 2U);
  std::vector<DescriptorMatch> found;
  EXPECT_THROW(index->search(std::span(values).first(100), 1, found, {}), Error);
  EXPECT_THROW(make_exact_index(std::span(values).first(353), Measure::kL2), Error);
  values[400] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(index->search(values, 1, found, {}), Error);
  EXPECT_THROW(make_exact_index(values, Measure::kL2), Error);
  values[400] = -0.1F;
  EXPECT_THROW(make_exact_index(values, Measure::kBhattacharyya), Error);
}

TEST(ExactIndex, StopsWhenAsked) {
  const std::vector<float> values = random_descriptors(2, 2, 7);
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  std::vector<DescriptorMatch> found;
  EXPECT_THROW(make_exact_index(values, Measure::kL2)->search(values, 1, found, context), Error);
}

}  // namespace
}  // namespace landmarkdb
