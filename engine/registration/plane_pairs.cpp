#include "engine/registration/plane_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

#include "engine/base/fast_exp.hpp"
#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {

static_assert(PointGroups::kLanes == PlaneSummer::kLanes && PlaneSummer::kNumbers == 8,
              "pairs are written as they are added up");

namespace {

constexpr std::size_t kLanes = PointGroups::kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef float Eights __attribute__((vector_size(8 * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/registration/plane_pairs_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<const PairKernels*> kSets LANDMARKDB_KERNEL_SETS(kKernels);

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
  return kSets.named(instruction_set);
}

const PairKernels& pair_kernels() {
  static const PairKernels* const best = kSets.best();
  return *best;
}

}  // namespace landmarkdb
