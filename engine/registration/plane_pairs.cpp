#include "engine/registration/plane_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <cstring>

namespace landmarkdb {

static_assert(PointGroups::kLanes == PlaneSummer::kLanes && PlaneSummer::kNumbers == 8,
              "pairs are written as they are added up");

namespace {

constexpr std::size_t kLanes = PointGroups::kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

namespace sse2 {
#include "engine/registration/plane_pairs_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace sse2

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "engine/registration/plane_pairs_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,prefer-vector-width=512")
namespace avx512 {
#include "engine/registration/plane_pairs_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx512
#pragma GCC pop_options
#endif

}  // namespace

PointGroups::PointGroups(std::span<const Eigen::Vector3f> points,
                         std::span<const Eigen::Vector3f> normals,
                         std::size_t stride)
    : size_((points.size() + stride - 1) / stride) {
  assert(points.size() == normals.size() && "one normal a point");
  values_.assign(groups() * kLanes * kNumbers, 0.0F);
  for (std::size_t i = 0; i < size_; ++i) {
    float* at = values_.data() + i / kLanes * kLanes * kNumbers + i % kLanes;
    for (int axis = 0; axis < 3; ++axis) {
      at[static_cast<std::size_t>(axis) * kLanes] = points[i * stride][axis];
      at[static_cast<std::size_t>(axis + 3) * kLanes] = normals[i * stride][axis];
    }
  }
}

PlaneSums pair_and_sum(const SurfaceGrid& target,
                       const PointGroups& points,
                       std::size_t groups,
                       const PointMotion& motion,
                       const PairOptions& options,
                       PlaneSummer summer) {
  PlaneSummer::Values values;
  for (std::size_t first = 0; first < groups; first += PlaneSummer::kMostGroups) {
    const std::size_t count = std::min(PlaneSummer::kMostGroups, groups - first);
    pair_kernels().pair(target, points.group(first), count, motion, options, values.data());
    summer.add(values.data(), count);
  }
  return summer.sums();
}

const PairKernels* pair_kernels(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512") == 0) {
    const bool has =
        __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
    return has ? &avx512::kKernels : nullptr;
  }
  if (std::strcmp(instruction_set, "avx2") == 0) {
    return __builtin_cpu_supports("avx2") != 0 ? &avx2::kKernels : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "sse2") == 0 ? &sse2::kKernels : nullptr;
}

const PairKernels& pair_kernels() {
  static const PairKernels* const best = [] {
    for (const char* name : {"avx512", "avx2"}) {
      if (const PairKernels* kernels = pair_kernels(name)) return kernels;
    }
    return pair_kernels("sse2");
  }();
  return *best;
}

}  // namespace landmarkdb
