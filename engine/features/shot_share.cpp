#include "engine/features/shot_share.hpp"

#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {
namespace {

constexpr std::int32_t kBins = kShotBins;
constexpr std::int32_t kSectors = 8;    // azimuths
constexpr std::int32_t kPerSector = 4;  // volumes: bit 1 the outer shell, bit 0 the upper half
constexpr float kQuarterTurn = 1.57079632679F;

constexpr std::size_t kLanes = kShotLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

#define LANDMARKDB_KERNEL_BODY "engine/features/shot_share_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<ShotShare> kSets LANDMARKDB_KERNEL_SETS(share);

}  // namespace

ShotShare shot_share(const char* instruction_set) { return kSets.named(instruction_set); }

ShotShare shot_share() {
  static const ShotShare best = kSets.best();
  return best;
}

}  // namespace landmarkdb
