#include "engine/matching/lanes.hpp"

#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = 16;
typedef float Lanes __attribute__((vector_size(kLanes * sizeof(float))));

// The helpers take and return vectors wider than the baseline's registers; they are inlined, so no
// calling convention is involved.

#define LANDMARKDB_KERNEL_BODY "engine/matching/lanes_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<const LaneKernels*> kSets LANDMARKDB_KERNEL_SETS(kKernels);

}  // namespace

const LaneKernels* lane_kernels(const char* instruction_set) {
  return kSets.named(instruction_set);
}

const LaneKernels& lane_kernels() {
  static const LaneKernels* const best = kSets.best();
  return *best;
}

}  // namespace landmarkdb
