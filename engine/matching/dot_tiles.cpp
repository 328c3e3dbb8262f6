#include "engine/matching/dot_tiles.hpp"

#include <cstring>
#include <initializer_list>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

// The accumulators of one pass stay in registers: 8 x 3 of 32 with AVX-512, 6 x 2 of 16 with AVX2.

namespace landmarkdb {
namespace {

constexpr std::size_t kBaselineQueries = 4;
constexpr std::size_t kBaselineWidth = 4;  // floats of an SSE register

// Vectors of four floats: 4 x 2 accumulators fit the sixteen registers of any 64-bit machine.
typedef float Four __attribute__((vector_size(kBaselineWidth * sizeof(float))));

Four load_four(const float* p) {
  Four v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

void baseline_tile(const float* queries, const float* targets, std::size_t length, float* tile) {
  for (std::size_t column = 0; column < kTileTargets; column += 2 * kBaselineWidth) {
    Four sum[kBaselineQueries][2] = {};
    for (std::size_t k = 0; k < length; ++k) {
      const float* t = targets + k * kTileTargets + column;
      const Four low = load_four(t);
      const Four high = load_four(t + kBaselineWidth);
      for (std::size_t i = 0; i < kBaselineQueries; ++i) {
        const float q = queries[k * kBaselineQueries + i];
        sum[i][0] += q * low;
        sum[i][1] += q * high;
      }
    }
    for (std::size_t i = 0; i < kBaselineQueries; ++i) {
      std::memcpy(tile + i * kTileTargets + column, sum[i], sizeof sum[i]);
    }
  }
}

constexpr DotKernel kBaseline{kBaselineQueries, baseline_tile};

#if defined(__x86_64__)

constexpr std::size_t kAvx2Queries = 6;
constexpr std::size_t kAvx2Width = 8;

[[gnu::target("avx2,fma")]] void avx2_tile(const float* queries,
                                           const float* targets,
                                           std::size_t length,
                                           float* tile) {
  for (std::size_t column = 0; column < kTileTargets; column += 2 * kAvx2Width) {
    __m256 sum[kAvx2Queries][2];
    for (auto& row : sum) row[0] = row[1] = _mm256_setzero_ps();
    for (std::size_t k = 0; k < length; ++k) {
      const float* t = targets + k * kTileTargets + column;
      const __m256 low = _mm256_loadu_ps(t);
      const __m256 high = _mm256_loadu_ps(t + kAvx2Width);
      for (std::size_t i = 0; i < kAvx2Queries; ++i) {
        const __m256 q = _mm256_broadcast_ss(queries + k * kAvx2Queries + i);
        sum[i][0] = _mm256_fmadd_ps(q, low, sum[i][0]);
        sum[i][1] = _mm256_fmadd_ps(q, high, sum[i][1]);
      }
    }
    for (std::size_t i = 0; i < kAvx2Queries; ++i) {
      _mm256_storeu_ps(tile + i * kTileTargets + column, sum[i][0]);
      _mm256_storeu_ps(tile + i * kTileTargets + column + kAvx2Width, sum[i][1]);
    }
  }
}

constexpr DotKernel kAvx2{kAvx2Queries, avx2_tile};

constexpr std::size_t kAvx512Queries = 8;
constexpr std::size_t kAvx512Width = 16;

[[gnu::target("avx512f")]] void avx512_tile(const float* queries,
                                            const float* targets,
                                            std::size_t length,
                                            float* tile) {
  __m512 sum[kAvx512Queries][3];
  for (auto& row : sum) row[0] = row[1] = row[2] = _mm512_setzero_ps();
  for (std::size_t k = 0; k < length; ++k) {
    const float* t = targets + k * kTileTargets;
    const __m512 first = _mm512_loadu_ps(t);
    const __m512 second = _mm512_loadu_ps(t + kAvx512Width);
    const __m512 third = _mm512_loadu_ps(t + 2 * kAvx512Width);
    for (std::size_t i = 0; i < kAvx512Queries; ++i) {
      const __m512 q = _mm512_set1_ps(queries[k * kAvx512Queries + i]);
      sum[i][0] = _mm512_fmadd_ps(q, first, sum[i][0]);
      sum[i][1] = _mm512_fmadd_ps(q, second, sum[i][1]);
      sum[i][2] = _mm512_fmadd_ps(q, third, sum[i][2]);
    }
  }
  for (std::size_t i = 0; i < kAvx512Queries; ++i) {
    float* row = tile + i * kTileTargets;
    _mm512_storeu_ps(row, sum[i][0]);
    _mm512_storeu_ps(row + kAvx512Width, sum[i][1]);
    _mm512_storeu_ps(row + 2 * kAvx512Width, sum[i][2]);
  }
}

constexpr DotKernel kAvx512{kAvx512Queries, avx512_tile};
static_assert(kAvx512Queries <= kMaxTileQueries);
static_assert(kTileTargets == 3 * kAvx512Width && kTileTargets % (2 * kAvx2Width) == 0);

#endif

}  // namespace

const DotKernel* dot_kernel(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512") == 0) {
    return __builtin_cpu_supports("avx512f") != 0 ? &kAvx512 : nullptr;
  }
  if (std::strcmp(instruction_set, "avx2") == 0) {
    const bool has = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    return has ? &kAvx2 : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "baseline") == 0 ? &kBaseline : nullptr;
}

const DotKernel& dot_kernel() {
  static const DotKernel* const best = [] {
    for (const char* name : {"avx512", "avx2"}) {
      if (const DotKernel* kernel = dot_kernel(name)) return kernel;
    }
    return &kBaseline;
  }();
  return *best;
}

}  // namespace landmarkdb
