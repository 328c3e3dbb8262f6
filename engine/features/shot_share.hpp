#pragma once

#include <cstddef>
#include <cstdint>

namespace landmarkdb {

inline constexpr std::int32_t kShotBins = 11;  // of the cosine

// What shot_share reads and writes: plain arrays, each of `count` elements rounded up to a multiple
// of kShotLanes (what lies past `count` may be any numbers, and its shares mean nothing).
inline constexpr std::size_t kShotLanes = 16;

struct ShotPoints {
  const float *x, *y, *z;     // offsets from the keypoint, cloud axes
  const float *nx, *ny, *nz;  // unit normals
  const float* squared_m2;    // squared length of the offset, > 0
};

struct ShotAxes {
  float x[3], y[3], z[3];  // of the local reference frame, in cloud coordinates
  float radius;
};

// For each point the five places of the histogram it adds to, and how much.
struct ShotShares {
  std::int32_t *own, *cosine, *shell, *elevation, *azimuth;
  float *own_weight, *cosine_weight, *shell_weight, *elevation_weight, *azimuth_weight;
};

// The same bytes on every instruction set; the best one is chosen when the program starts.
using ShotShare = void (*)(const ShotPoints& points,
                           std::size_t count,
                           const ShotAxes& axes,
                           ShotShares& shares);
ShotShare shot_share();

// That of one instruction set by name, "sse2", "avx2" or "avx512"; null where the machine lacks it.
ShotShare shot_share(const char* instruction_set);

}  // namespace landmarkdb
