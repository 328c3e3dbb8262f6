#include "engine/features/shot_share.hpp"

#include <cstring>
#include <initializer_list>

namespace landmarkdb {
namespace {

constexpr std::int32_t kBins = kShotBins;
constexpr std::int32_t kSectors = 8;    // azimuths
constexpr std::int32_t kPerSector = 4;  // volumes: bit 1 the outer shell, bit 0 the upper half
constexpr float kQuarterTurn = 1.57079632679F;

constexpr std::size_t kLanes = kShotLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

namespace sse2 {
#include "engine/features/shot_share_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace sse2

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2 {
#include "engine/features/shot_share_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")
namespace avx512 {
#include "engine/features/shot_share_body.hpp"  // NOLINT(bugprone-suspicious-include): see there
}  // namespace avx512
#pragma GCC pop_options

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}
#endif

}  // namespace

ShotShare shot_share(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512") == 0) return has_avx512() ? &avx512::share : nullptr;
  if (std::strcmp(instruction_set, "avx2") == 0) {
    return __builtin_cpu_supports("avx2") != 0 ? &avx2::share : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "sse2") == 0 ? &sse2::share : nullptr;
}

ShotShare shot_share() {
  static const ShotShare best = [] {
    for (const char* name : {"avx512", "avx2"}) {
      if (const ShotShare share = shot_share(name)) return share;
    }
    return shot_share("sse2");
  }();
  return best;
}

}  // namespace landmarkdb
