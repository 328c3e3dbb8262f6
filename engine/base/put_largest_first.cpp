#include "engine/base/put_largest_first.hpp"

#include <algorithm>
#include <array>
#include <functional>

namespace landmarkdb {

namespace {

// The word in the middle of a few spread over the range.
std::uint64_t middle_of(std::span<const std::uint64_t> range) {
  constexpr std::size_t kSampled = 9;
  std::array<std::uint64_t, kSampled> sample{};
  for (std::size_t i = 0; i < kSampled; ++i)
    sample[i] = range[i * (range.size() - 1) / (kSampled - 1)];
  std::nth_element(sample.begin(), sample.begin() + kSampled / 2, sample.end());
  return sample[kSampled / 2];
}

// Those above `pivot` ahead of the others; how many there are. Without a branch on what they are,
// of which half would be mispredicted.
std::size_t part(std::span<std::uint64_t> range, std::uint64_t pivot) {
  std::size_t above = 0;
  for (std::uint64_t& word : range) {
    const std::uint64_t here = word;
    word = range[above];
    range[above] = here;
    above += here > pivot ? 1U : 0U;
  }
  return above;
}

}  // namespace

void put_largest_first(std::span<std::uint64_t> words, std::size_t count) {
  if (count == 0 || words.size() <= count) return;
  constexpr std::size_t kFew = 32;
  while (words.size() > kFew) {
    const std::size_t above = part(words, middle_of(words));
    if (above == count) return;
    if (above > count) {
      words = words.first(above);
    } else {
      words = words.subspan(above);
      count -= above;
    }
  }
  std::nth_element(words.begin(),
                   words.begin() + static_cast<std::ptrdiff_t>(count) - 1,
                   words.end(),
                   std::greater<>());
}

}  // namespace landmarkdb
