#include "engine/retrieval/index_cache.hpp"

#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

std::vector<float> rows(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(count * kShotLength);
  for (float& v : values) v = static_cast<float>(random.uniform());
  return values;
}

std::shared_ptr<const DescriptorIndex> get(IndexCache& cache,
                                           const std::vector<float>& values,
                                           Measure measure,
                                           Search search) {
  return cache.get(
      values.data(), values.size() / kShotLength, measure, search, [&] { return values; });
}

TEST(IndexCache, MakesOneOfEachMeasureAndMethodAndKeepsIt) {
  IndexCache cache;
  const std::vector<float> values = rows(20, 1);
  const auto l1 = get(cache, values, Measure::kL1, Search::kExact);
  EXPECT_EQ(get(cache, values, Measure::kL1, Search::kExact), l1);
  EXPECT_NE(get(cache, values, Measure::kChi2, Search::kExact), l1);
  EXPECT_NE(get(cache, values, Measure::kL1, Search::kFlann), l1);
  EXPECT_EQ(cache.made(), 3U);
  EXPECT_EQ(cache.bytes(), 3 * values.size() * sizeof(float));
  EXPECT_EQ(l1->size(), 20U);
}

TEST(IndexCache, AnswersAsAnIndexMadeForTheQuery) {
  IndexCache cache;
  const std::vector<float> values = rows(30, 2);
  const std::vector<float> queries = rows(5, 3);
  for (const Measure measure : {Measure::kL2, Measure::kIntersection, Measure::kBhattacharyya}) {
    std::vector<DescriptorMatch> kept, fresh;
    get(cache, values, measure, Search::kFlann)->search(queries, 3, kept, {});
    make_index(values, measure, Search::kFlann)->search(queries, 3, fresh, {});
    EXPECT_EQ(kept, fresh);
  }
}

TEST(IndexCache, LetsGoOfWhatWasNotUsedForLongest) {
  const std::vector<float> a = rows(10, 4);
  const std::vector<float> b = rows(10, 5);
  const std::vector<float> c = rows(10, 6);
  IndexCache cache(2 * a.size() * sizeof(float));
  const auto of_a = get(cache, a, Measure::kL1, Search::kExact);
  const auto of_b = get(cache, b, Measure::kL1, Search::kExact);
  EXPECT_EQ(get(cache, a, Measure::kL1, Search::kExact), of_a);
  get(cache, c, Measure::kL1, Search::kExact);  // b goes
  EXPECT_EQ(cache.bytes(), 2 * a.size() * sizeof(float));
  EXPECT_EQ(get(cache, a, Measure::kL1, Search::kExact), of_a);
  EXPECT_EQ(cache.made(), 3U);
  EXPECT_NE(get(cache, b, Measure::kL1, Search::kExact), of_b);
  EXPECT_EQ(of_b->size(), 10U);  // its user's still
}

TEST(IndexCache, MakesButDoesNotKeepWhatIsLargerThanAllOfIt) {
  const std::vector<float> values = rows(10, 7);
  IndexCache cache(100);
  EXPECT_EQ(get(cache, values, Measure::kL2, Search::kExact)->size(), 10U);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(IndexCache, MakesOneForManyThreadsAtOnce) {
  IndexCache cache;
  const std::vector<float> values = rows(200, 8);
  std::vector<std::shared_ptr<const DescriptorIndex>> got(8);
  {
    std::vector<std::jthread> threads;
    for (auto& slot : got) {
      threads.emplace_back([&] { slot = get(cache, values, Measure::kChi2, Search::kFlann); });
    }
  }
  EXPECT_THAT(got, ::testing::Each(got[0]));
  EXPECT_EQ(cache.made(), 1U);
}

}  // namespace
}  // namespace landmarkdb
