#include "engine/registration/sight_rays.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/instruction_sets.hpp"
#include "engine/registration/equal_angles.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kLanes = 16;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/registration/sight_rays_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<SightKernel> kSets LANDMARKDB_KERNEL_SETS(look);

}  // namespace

SightKernel sight_kernel(const char* instruction_set) { return kSets.named(instruction_set); }

SightKernel sight_kernel() {
  static const SightKernel best = kSets.best();
  return best;
}

}  // namespace landmarkdb
