#include "engine/matching/lanes.hpp"

#include <cstring>
#include <initializer_list>

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));

// The helpers take and return vectors wider than the baseline's registers; they are inlined, so no
// calling convention is involved.

namespace sse2 {
#include "engine/matching/lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace sse2

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "engine/matching/lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,prefer-vector-width=512")
namespace avx512 {
#include "engine/matching/lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

const LaneKernels* lane_kernels(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512") == 0) {
    return __builtin_cpu_supports("avx512f") != 0 ? &avx512::kKernels : nullptr;
  }
  if (std::strcmp(instruction_set, "avx2") == 0) {
    return __builtin_cpu_supports("avx2") != 0 ? &avx2::kKernels : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "sse2") == 0 ? &sse2::kKernels : nullptr;
}

const LaneKernels& lane_kernels() {
  static const LaneKernels* const best = [] {
    for (const char* name : {"avx512", "avx2"}) {
      if (const LaneKernels* kernels = lane_kernels(name)) return kernels;
    }
    return lane_kernels("sse2");
  }();
  return *best;
}

}  // namespace landmarkdb
