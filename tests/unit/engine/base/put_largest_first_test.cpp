#include "engine/base/put_largest_first.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using ::testing::UnorderedElementsAreArray;

// No two alike: the index is part of the word. The upper halves repeat where `values` are few.
std::vector<std::uint64_t> some_words(std::size_t count, std::uint64_t values) {
  Random random(7);
  std::vector<std::uint64_t> words(count);
  for (std::size_t i = 0; i < count; ++i) words[i] = random.below(values) << 32U | i;
  return words;
}

void expect_largest_first(std::vector<std::uint64_t> words, std::size_t count) {
  std::vector<std::uint64_t> sorted = words;
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  put_largest_first(words, count);
  const std::size_t ahead = std::min(count, words.size());
  const auto at = static_cast<std::ptrdiff_t>(ahead);
  EXPECT_THAT(std::vector(words.begin(), words.begin() + at),
              UnorderedElementsAreArray(sorted.begin(), sorted.begin() + at))
      << "of " << words.size() << " the largest " << count;
  EXPECT_THAT(std::vector(words.begin() + at, words.end()),
              UnorderedElementsAreArray(sorted.begin() + at, sorted.end()));
}

TEST(PutLargestFirst, SplitsWordsOfManyValuesAndOfFew) {
  for (const std::uint64_t values : {std::uint64_t{1}, std::uint64_t{3}, std::uint64_t{1} << 31U}) {
    for (const std::size_t size : {1U, 2U, 31U, 33U, 1000U}) {
      const std::vector<std::uint64_t> words = some_words(size, values);
      for (const std::size_t count : {std::size_t{1}, size / 2, size - 1, size, size + 1}) {
        expect_largest_first(words, count);
      }
    }
  }
}

TEST(PutLargestFirst, SplitsWhatIsSortedAlready) {
  std::vector<std::uint64_t> words = some_words(500, std::uint64_t{1} << 31U);
  std::sort(words.begin(), words.end());
  expect_largest_first(words, 120);
  std::reverse(words.begin(), words.end());
  expect_largest_first(words, 120);
}

TEST(PutLargestFirst, TakesNothingOfNothing) {
  expect_largest_first({}, 0);
  expect_largest_first({}, 4);
  expect_largest_first({5, 6, 7}, 0);
}

}  // namespace
}  // namespace landmarkdb
