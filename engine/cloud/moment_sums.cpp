#include "engine/cloud/moment_sums.hpp"

#include <cstdint>

#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kLanes = kMomentLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/cloud/moment_sums_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<MomentSums> kSets LANDMARKDB_KERNEL_SETS(add_moments);

}  // namespace

MomentSums moment_sums(const char* instruction_set) { return kSets.named(instruction_set); }

MomentSums moment_sums() {
  static const MomentSums best = kSets.best();
  return best;
}

}  // namespace landmarkdb
