#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// A stored descriptor and its dissimilarity (see measures.hpp) to the query's: 0 exact.
struct DescriptorMatch {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t index = kNone;  // kNone: the index holds fewer than k
  float distance = std::numeric_limits<float>::infinity();
  bool operator==(const DescriptorMatch&) const = default;
};

// Finds the most similar of many stored descriptors. Never changes once built.
class DescriptorIndex {
 public:
  virtual ~DescriptorIndex() = default;

  // The `k` nearest of each query, nearest first, the lower index first of two as near.
  //
  // `queries` is Q x kShotLength, row-major. `out` becomes Q x k, row-major; rows of an index with
  // fewer than k descriptors end in matches whose index is kNone. The same bytes for any
  // `context.threads`. Throws Error{kInvalidArgument} for queries that are not whole rows or hold
  // numbers that are negative or not finite; what `context` throws. Thread-safe.
  virtual void search(std::span<const float> queries,
                      std::size_t k,
                      std::vector<DescriptorMatch>& out,
                      const RunContext& context) const = 0;

  virtual std::size_t size() const = 0;
};

// Compares each query with each stored descriptor (N x kShotLength, row-major; copied). The oracle
// of all others. Ranks l2, correlation and bhattacharyya by a matrix product and evaluates the
// candidates again, so that the answer is the same on every machine. Throws like search().
std::unique_ptr<DescriptorIndex> make_exact_index(std::span<const float> values, Measure measure);

// FLANN's single kd-tree. `epsilon` 0: exact; otherwise each neighbour's distance, in the tree's
// own terms (squared for the Euclidean measures, plain for the others), is at most (1 + epsilon)
// times that of the true one. Unlike FLANN's randomised trees two builds over the same data give
// the same answers. Of more than k descriptors exactly as far as the k-th any may be returned.
std::unique_ptr<DescriptorIndex> make_flann_index(std::span<const float> values,
                                                  Measure measure,
                                                  float epsilon = 0.0F);

}  // namespace landmarkdb
