#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landmarkdb {

// Brings the `count` largest of the words to the front, in no order. No two words are the same.
// Expected cost O(N), without a branch on what the words are.
void put_largest_first(std::span<std::uint64_t> words, std::size_t count);

}  // namespace landmarkdb
