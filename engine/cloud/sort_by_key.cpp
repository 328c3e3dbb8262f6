#include "engine/cloud/sort_by_key.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "engine/base/parallel.hpp"

namespace landmarkdb {
namespace {

// A radix sort, least significant digit first. Digits are cut from the bits in which the keys
// differ: keys packed of several numbers have gaps. Threads count and move a chunk each.
template <typename Item, typename KeyOf>
void radix_sort(std::vector<Item>& items,
                std::uint64_t differing,
                const KeyOf& key_of,
                const RunContext& context) {
  constexpr int kDigitBits = 11;  // 2,048 counters stay in the first-level cache
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  constexpr std::size_t kWorthAThread = std::size_t{1} << 15U;
  const std::size_t chunks = std::clamp<std::size_t>(
      items.size() / kWorthAThread, 1, static_cast<std::size_t>(std::max(context.threads, 1)));
  std::vector<std::array<std::uint32_t, kDigits>> next(chunks);
  std::vector<Item> other(items.size());
  while (differing != 0) {
    context.check("sort");
    const int shift = std::countr_zero(differing);
    differing &= ~(std::uint64_t{kDigits - 1} << shift);
    const auto digit = [&](const Item& item) { return (key_of(item) >> shift) & (kDigits - 1); };
    const auto for_each_of = [&](std::size_t chunk, const auto& visit) {
      const std::size_t end = items.size() * (chunk + 1) / chunks;
      for (std::size_t i = items.size() * chunk / chunks; i < end; ++i) visit(items[i]);
    };
    parallel_each(chunks, context.threads, [&](std::size_t chunk) {
      next[chunk].fill(0);
      for_each_of(chunk, [&](const Item& item) { ++next[chunk][digit(item)]; });
    });
    std::uint32_t start = 0;
    for (std::size_t d = 0; d < kDigits; ++d) {
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        const std::uint32_t count = next[chunk][d];
        next[chunk][d] = start;
        start += count;
      }
    }
    parallel_each(chunks, context.threads, [&](std::size_t chunk) {
      for_each_of(chunk, [&](const Item& item) { other[next[chunk][digit(item)]++] = item; });
    });
    items.swap(other);
  }
}

}  // namespace

void sort_by_key(std::vector<Keyed>& items, const RunContext& context) {
  std::uint64_t differing = 0;
  for (const Keyed& item : items) differing |= item.key ^ items.front().key;
  radix_sort(
      items, differing, [](const Keyed& item) { return item.key; }, context);
}

void sort_words(std::vector<std::uint64_t>& words, int first_bit, const RunContext& context) {
  std::uint64_t differing = 0;
  for (const std::uint64_t word : words) differing |= word ^ words.front();
  radix_sort(
      words, differing >> first_bit << first_bit, [](std::uint64_t word) { return word; }, context);
}

}  // namespace landmarkdb
