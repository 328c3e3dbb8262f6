#pragma once

#include <cstddef>

namespace landmarkdb {

inline constexpr std::size_t kTileTargets = 48;  // targets a tile; all kernels take this packing
inline constexpr std::size_t kMaxTileQueries = 8;

// Inner products of a few query vectors with kTileTargets target vectors, as fast as the machine
// can. Sums are fused and ordered differently from one instruction set to the next: good to 1e-4
// of the lengths' product, not to the last bit. Plain arrays of any alignment. Thread-safe.
struct DotKernel {
  std::size_t queries;  // query vectors a tile
  // `packed_queries[k * queries + i]`, `packed_targets[k * kTileTargets + j]`, k < length;
  // writes `tile[i * kTileTargets + j]`.
  void (*tile)(const float* packed_queries,
               const float* packed_targets,
               std::size_t length,
               float* tile);
};

// The kernel for this machine.
const DotKernel& dot_kernel();

// That of one instruction set by name, "baseline", "avx2" or "avx512"; null where the machine lacks
// it.
const DotKernel* dot_kernel(const char* instruction_set);

}  // namespace landmarkdb
