#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "engine/matching/descriptor_index.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// The index of this kind over rows of descriptors.
std::shared_ptr<const DescriptorIndex> make_index(std::span<const float> values,
                                                  Measure measure,
                                                  Search search);

// Descriptor indexes that a query asked for and the next may ask for again: made on first use, one
// of each, by one thread while others that want the same wait.
//
// Known by whose rows they are: a key stands for the same rows for as long as the cache lives. When
// those kept would take more than `most_bytes` the ones not used for longest are let go; an index
// that is in use lives on with its user. One that is larger by itself is made and not kept.
// Thread-safe.
class IndexCache {
 public:
  // Half of what a server with a thousand places holds besides.
  static constexpr std::size_t kMostBytes = std::size_t{1} << 30;

  explicit IndexCache(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  // `values` gives the `rows` rows of kShotLength that `key` stands for. Throws what making it
  // throws; the next asker tries again.
  std::shared_ptr<const DescriptorIndex> get(const void* key,
                                             std::size_t rows,
                                             Measure measure,
                                             Search search,
                                             const std::function<std::vector<float>()>& values);

  std::size_t bytes() const;  // of the descriptors in the indexes kept
  std::size_t made() const;   // how many were made so far

 private:
  struct Slot {
    const void* key = nullptr;
    std::size_t bytes = 0;
    Measure measure = Measure::kL2;
    Search search = Search::kExact;
    std::mutex making;
    std::shared_ptr<const DescriptorIndex> index;  // null until made; guarded by `making`
  };

  std::shared_ptr<Slot> slot_of(const void* key, std::size_t bytes, Measure measure, Search search);

  std::size_t most_bytes_;
  mutable std::mutex mutex_;                // of all below
  std::list<std::shared_ptr<Slot>> slots_;  // last used first
  std::size_t bytes_ = 0;
  std::size_t made_ = 0;
};

}  // namespace landmarkdb
