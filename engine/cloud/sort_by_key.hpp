#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// What is sorted: a key, and the index of what it belongs to.
struct Keyed {
  std::uint64_t key = 0;
  std::uint32_t index = 0;
};

// Sorts by ascending key; items of one key keep their order. Cost: a pass for every 11 bits among
// those in which the keys differ, on the threads of the context. Throws what `context.check` does.
void sort_by_key(std::vector<Keyed>& items, const RunContext& context = {});

// The same of words, each a key from `first_bit` (below 64) on, above what belongs to it.
void sort_words(std::vector<std::uint64_t>& words, int first_bit, const RunContext& context = {});

}  // namespace landmarkdb
