#pragma once

#include <array>
#include <cstddef>

namespace landmarkdb {

// Of points near a centre: their number, and the sums of their offsets from it and of the products
// of these. Metres, axes of the cloud.
struct Moments {
  float count = 0.0F;
  std::array<float, 3> sum{};       // x, y, z
  std::array<float, 6> products{};  // xx, xy, xz, yy, yz, zz
};

inline constexpr std::size_t kMomentLanes = 16;

// Adds up the points of plain arrays, `count` of them, a multiple of kMomentLanes, that are nearer
// to (cx, cy, cz) than the square root of `squared_m2`. The same bytes on every instruction set;
// the best one is chosen when the program starts.
using MomentSums = Moments (*)(const float* x,
                               const float* y,
                               const float* z,
                               std::size_t count,
                               const float* centre,
                               float squared_m2);
MomentSums moment_sums();

// That of one instruction set by name, "sse2", "avx2" or "avx512"; null where the machine lacks it.
MomentSums moment_sums(const char* instruction_set);

}  // namespace landmarkdb
