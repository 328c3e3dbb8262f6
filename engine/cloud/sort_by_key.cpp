#include "engine/cloud/sort_by_key.hpp"

#include <array>
#include <bit>
#include <cstddef>

namespace landmarkdb {

// A radix sort, least significant digit first. Digits are cut from the bits in which the keys
// differ: keys packed of several numbers have gaps.
void sort_by_key(std::vector<Keyed>& items, const RunContext& context) {
  constexpr int kDigitBits = 11;  // 2,048 counters stay in the first-level cache
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  std::uint64_t differing = 0;
  for (const Keyed& item : items) differing |= item.key ^ items.front().key;
  std::vector<Keyed> other(items.size());
  while (differing != 0) {
    context.check("sort");
    const int shift = std::countr_zero(differing);
    differing &= ~(std::uint64_t{kDigits - 1} << shift);
    std::array<std::uint32_t, kDigits + 1> start{};
    const auto digit = [shift](const Keyed& item) { return (item.key >> shift) & (kDigits - 1); };
    for (const Keyed& item : items) ++start[digit(item) + 1];
    for (std::size_t d = 1; d <= kDigits; ++d) start[d] += start[d - 1];
    for (const Keyed& item : items) other[start[digit(item)]++] = item;
    items.swap(other);
  }
}

}  // namespace landmarkdb
