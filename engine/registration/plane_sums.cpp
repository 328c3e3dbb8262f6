#include "engine/registration/plane_sums.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "engine/base/fast_exp.hpp"
#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = PlaneSummer::kLanes;
constexpr std::size_t kNumbers = PlaneSummer::kNumbers;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/registration/plane_sums_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<PlaneKernel> kSets LANDMARKDB_KERNEL_SETS(add_planes);

float factor_of(PairWeight weight, double scale_m) {
  const double inverse = 1.0 / (scale_m * scale_m);
  return static_cast<float>(weight == PairWeight::kGaussian ? -0.5 * inverse : inverse);
}

}  // namespace

PlaneKernel plane_kernel(const char* instruction_set) { return kSets.named(instruction_set); }

PlaneSummer::PlaneSummer(PairWeight weight, double scale_m)
    : weight_(weight), factor_(factor_of(weight, scale_m)) {}

void PlaneSummer::add(const float* values, std::size_t groups) {
  static const PlaneKernel kernel = kSets.best();
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
