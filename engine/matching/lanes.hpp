#pragma once

#include <cstddef>

namespace landmarkdb {

// Sums over two float arrays of length n, each in 16 fixed lanes that are added in a fixed order,
// without fused multiply-adds: the same bytes whatever vector width the machine offers. The widest
// one is chosen when the program starts. Plain arrays of any alignment. Thread-safe.
struct LaneKernels {
  float (*squared_l2)(const float* a, const float* b, std::size_t n);  // sum (a - b)^2
  float (*l1)(const float* a, const float* b, std::size_t n);          // sum |a - b|
  float (*chi2)(const float* a, const float* b, std::size_t n);        // sum (a-b)^2/(a+b), 0/0 = 0
  float (*intersection)(const float* a, const float* b, std::size_t n);  // sum min(a, b)
};

// The kernels for this machine.
const LaneKernels& lane_kernels();

// Those of one instruction set by name, "sse2", "avx2" or "avx512", for the test that all agree;
// null where the machine lacks it.
const LaneKernels* lane_kernels(const char* instruction_set);

}  // namespace landmarkdb
