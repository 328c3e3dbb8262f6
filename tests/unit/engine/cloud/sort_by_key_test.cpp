#include "engine/cloud/sort_by_key.hpp"

#include <algorithm>
#include <stop_token>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// Keys of the bits in `mask`; the index is the place before sorting.
std::vector<Keyed> random_items(std::size_t count, std::uint64_t mask, Random& random) {
  std::vector<Keyed> items;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto high = static_cast<std::uint64_t>(random.uniform(0.0, 4294967295.0));
    const auto low = static_cast<std::uint64_t>(random.uniform(0.0, 4294967295.0));
    items.push_back({((high << 32U) | low) & mask, i});
  }
  return items;
}

void expect_like_stable_sort(std::vector<Keyed> items) {
  std::vector<Keyed> expected = items;
  std::stable_sort(expected.begin(), expected.end(), [](const Keyed& a, const Keyed& b) {
    return a.key < b.key;
  });
  sort_by_key(items);
  ASSERT_EQ(items.size(), expected.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    ASSERT_EQ(items[i].key, expected[i].key) << i;
    ASSERT_EQ(items[i].index, expected[i].index) << i;
  }
}

TEST(SortByKey, SortsLikeAStableSortWhateverBitsTheKeysHave) {
  Random random(1);
  for (const std::uint64_t mask :
       {~std::uint64_t{0},
        std::uint64_t{0},
        std::uint64_t{1} << 63U,
        std::uint64_t{0x3f},
        std::uint64_t{0x7f} | (std::uint64_t{0x7f} << 21U) | (std::uint64_t{0x7f} << 42U),
        std::uint64_t{0xfff} << 52U}) {
    for (const std::size_t count : {0U, 1U, 2U, 3000U}) {
      expect_like_stable_sort(random_items(count, mask, random));
    }
  }
}

// Enough items that each thread has its share.
TEST(SortByKey, SortsTheSameOnAnyNumberOfThreads) {
  Random random(3);
  const std::vector<Keyed> items = random_items(200'000, std::uint64_t{0xffffff} << 20U, random);
  std::vector<Keyed> alone = items;
  sort_by_key(alone);
  for (const int threads : {2, 3, 8}) {
    RunContext context;
    context.threads = threads;
    std::vector<Keyed> sorted = items;
    sort_by_key(sorted, context);
    for (std::size_t i = 0; i < items.size(); ++i) ASSERT_EQ(sorted[i].index, alone[i].index) << i;
  }
}

TEST(SortWords, SortsByTheUpperBitsAndKeepsTheOrderOfTheRest) {
  Random random(4);
  for (const int first_bit : {0, 7, 40}) {
    std::vector<std::uint64_t> words;
    for (const Keyed& item : random_items(3000, ~std::uint64_t{0}, random)) {
      words.push_back(item.key & ~(std::uint64_t{0xff} << first_bit));  // many keys of one kind
    }
    std::vector<std::uint64_t> expected = words;
    std::stable_sort(expected.begin(), expected.end(), [&](std::uint64_t a, std::uint64_t b) {
      return a >> first_bit < b >> first_bit;
    });
    sort_words(words, first_bit);
    ASSERT_EQ(words, expected);
  }
}

TEST(SortByKey, EndsWhenAskedTo) {
  Random random(2);
  std::vector<Keyed> items = random_items(100, ~std::uint64_t{0}, random);
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_THROW(sort_by_key(items, context), Error);
}

}  // namespace
}  // namespace landmarkdb
