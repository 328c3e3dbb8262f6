#pragma once

#include <cstring>
#include <initializer_list>

namespace landmarkdb {

// A kernel, or a table of some, compiled for several instruction sets by instruction_sets_body.hpp;
// `Kernel` is a pointer, null where the machine is of another kind.
template <typename Kernel>
struct KernelSets {
  Kernel sse2 = nullptr;  // the baseline, on other machines too
  Kernel avx2 = nullptr;
  Kernel avx512 = nullptr;  // with what every such machine since Skylake has: F, BW, DQ and VL

  // That of one instruction set by name, "sse2", "avx2" or "avx512"; null where the machine lacks
  // it.
  Kernel named(const char* instruction_set) const {
#if defined(__x86_64__)
    if (std::strcmp(instruction_set, "avx512") == 0) {
      const bool has =
          __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
          __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
      return has ? avx512 : nullptr;
    }
    if (std::strcmp(instruction_set, "avx2") == 0) {
      return __builtin_cpu_supports("avx2") != 0 ? avx2 : nullptr;
    }
#endif
    return std::strcmp(instruction_set, "sse2") == 0 ? sse2 : nullptr;
  }

  // The best this machine has.
  Kernel best() const {
    for (const char* name : {"avx512", "avx2"}) {
      if (const Kernel kernel = named(name)) return kernel;
    }
    return sse2;
  }
};

}  // namespace landmarkdb

// Initialises a KernelSets with what the body calls `name`.
#if defined(__x86_64__)
#define LANDMARKDB_KERNEL_SETS(name) \
  { &sse2::name, &avx2::name, &avx512::name }
#else
#define LANDMARKDB_KERNEL_SETS(name) \
  { &sse2::name }
#endif
