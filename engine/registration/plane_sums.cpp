#include "engine/registration/plane_sums.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = PlaneSummer::kLanes;
constexpr std::size_t kNumbers = PlaneSummer::kNumbers;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

namespace sse2 {
#include "engine/registration/plane_sums_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace sse2

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "engine/registration/plane_sums_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,prefer-vector-width=512")
namespace avx512 {
#include "engine/registration/plane_sums_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx512
#pragma GCC pop_options
#endif

PlaneKernel best_kernel() {
  for (const char* name : {"avx512", "avx2"}) {
    if (const PlaneKernel kernel = plane_kernel(name)) return kernel;
  }
  return plane_kernel("sse2");
}

float factor_of(PairWeight weight, double scale_m) {
  const double inverse = 1.0 / (scale_m * scale_m);
  return static_cast<float>(weight == PairWeight::kGaussian ? -0.5 * inverse : inverse);
}

}  // namespace

PlaneKernel plane_kernel(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512") == 0) {
    return __builtin_cpu_supports("avx512f") != 0 ? &avx512::add_planes : nullptr;
  }
  if (std::strcmp(instruction_set, "avx2") == 0) {
    return __builtin_cpu_supports("avx2") != 0 ? &avx2::add_planes : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "sse2") == 0 ? &sse2::add_planes : nullptr;
}

PlaneSummer::PlaneSummer(PairWeight weight, double scale_m)
    : weight_(weight), factor_(factor_of(weight, scale_m)) {}

void PlaneSummer::add(const float* values, std::size_t groups) {
  static const PlaneKernel kernel = best_kernel();
  assert(groups <= kMostGroups && "sums in single precision stay short");
  std::array<float, kPlaneTerms> terms{};
  kernel(values, groups, weight_, factor_, terms.data());
  for (std::size_t group = 0; group < groups; ++group) {
    const float* factors = values + (group * kNumbers + kNumbers - 1) * kLanes;
    sums_.pairs += static_cast<std::size_t>(
        std::count_if(factors, factors + kLanes, [](float factor) { return factor > 0.0F; }));
  }
  std::size_t term = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) {
      const auto value = static_cast<double>(terms[term++]);
      sums_.A(row, column) += value;
      if (row != column) sums_.A(column, row) += value;
    }
  }
  for (int row = 0; row < 6; ++row) sums_.b(row) -= static_cast<double>(terms[term++]);
  sums_.weight += static_cast<double>(terms[term++]);
  sums_.squared_m2 += static_cast<double>(terms[term++]);
}

}  // namespace landmarkdb
