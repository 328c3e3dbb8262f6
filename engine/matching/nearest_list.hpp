#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/matching/descriptor_index.hpp"

namespace landmarkdb {

// By distance, then index: the order of every answer.
inline bool nearer(const DescriptorMatch& a, const DescriptorMatch& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
}

// The `k` nearest matches offered so far, kept as a heap whose top is the farthest. What it holds
// does not depend on the order of offers. Not thread-safe.
class NearestList {
 public:
  explicit NearestList(std::size_t k) : k_(k) {}

  bool full() const { return heap_.size() >= k_; }
  // Of the farthest match held; only when full and k > 0.
  float farthest() const { return heap_.front().distance; }

  void offer(const DescriptorMatch& match) {
    if (!full()) {
      heap_.push_back(match);
      std::push_heap(heap_.begin(), heap_.end(), nearer);
    } else if (k_ > 0 && nearer(match, heap_.front())) {
      std::pop_heap(heap_.begin(), heap_.end(), nearer);
      heap_.back() = match;
      std::push_heap(heap_.begin(), heap_.end(), nearer);
    }
  }

  // Writes the matches, nearest first, to `out[0 .. k)`; places past the last keep their value.
  void write(DescriptorMatch* out) {
    std::sort_heap(heap_.begin(), heap_.end(), nearer);
    std::copy(heap_.begin(), heap_.end(), out);
  }

 private:
  std::size_t k_;
  std::vector<DescriptorMatch> heap_;
};

}  // namespace landmarkdb
