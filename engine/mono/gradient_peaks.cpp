#include "engine/mono/gradient_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>

// Compiled without errno for the roots, and without fused multiply-adds: the same on all machines.
namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = 4;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

Floats floats(const std::int32_t* values) {
  Ints v;
  std::memcpy(&v, values, sizeof v);
  return __builtin_convertvector(v, Floats);
}

Floats roots(const std::int32_t* values) {
  float root[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) root[i] = std::sqrt(static_cast<float>(values[i]));
  Floats v;
  std::memcpy(&v, root, sizeof v);
  return v;
}

// What is looked at of kLanes pixels.
struct Pixels {
  std::int32_t x[kLanes], gx[kLanes], gy[kLanes];
  std::int32_t before[kLanes], here[kLanes], after[kLanes];  // squared lengths
  std::int32_t in_row[kLanes];                               // all bits or none

  Pixels(const GradientRows& rows, std::span<const std::int32_t> columns) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      x[i] = columns[std::min(i, columns.size() - 1)];
      const std::size_t at = static_cast<std::size_t>(x[i]) + kRowMargin;
      gx[i] = rows.gx[at];
      gy[i] = rows.gy[at];
      here[i] = rows.squared[at];
      const std::int32_t row = std::abs(gx[i]) > std::abs(gy[i]) ? -1 : 0;
      before[i] = (rows.squared[at - 1] & row) | (rows.above[at] & ~row);
      after[i] = (rows.squared[at + 1] & row) | (rows.below[at] & ~row);
      in_row[i] = row;
    }
  }
};

// Offset of a parabola's top through (-1, before), (0, top), (1, after), within +-0.5.
Floats tops_of_parabolas(Floats before, Floats top, Floats after) {
  const Floats zero = {}, half = zero + 0.5F;
  const Floats curve = before - 2.0F * top + after;
  const Floats offset = 0.5F * (before - after) / curve;
  const Floats low = offset < -half ? -half : offset;
  return curve < zero ? (half < low ? half : low) : zero;
}

// Four lanes of the same point each.
void store(Floats u, Floats v, Floats nx, Floats ny, std::span<EdgePoint> points) {
  static_assert(sizeof(EdgePoint) == sizeof(Floats));
  const Floats uv_low = __builtin_shufflevector(u, v, 0, 4, 1, 5);
  const Floats uv_high = __builtin_shufflevector(u, v, 2, 6, 3, 7);
  const Floats n_low = __builtin_shufflevector(nx, ny, 0, 4, 1, 5);
  const Floats n_high = __builtin_shufflevector(nx, ny, 2, 6, 3, 7);
  const Floats four[kLanes] = {__builtin_shufflevector(uv_low, n_low, 0, 1, 4, 5),
                               __builtin_shufflevector(uv_low, n_low, 2, 3, 6, 7),
                               __builtin_shufflevector(uv_high, n_high, 0, 1, 4, 5),
                               __builtin_shufflevector(uv_high, n_high, 2, 3, 6, 7)};
  if (points.size() == kLanes) {  // of a size that is known: at once
    std::memcpy(static_cast<void*>(points.data()), four, sizeof four);
  } else {
    std::memcpy(static_cast<void*>(points.data()), four, points.size_bytes());
  }
}

}  // namespace

void place_peaks(const GradientRows& rows,
                 std::uint32_t y,
                 std::span<const std::int32_t> columns,
                 EdgePoint* points,
                 float* lengths) {
  const Floats row = Floats{} + static_cast<float>(y);
  for (std::size_t first = 0; first < columns.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, columns.size() - first);
    const Pixels pixels(rows, columns.subspan(first, count));
    const Floats length = roots(pixels.here);
    const Floats offset = tops_of_parabolas(roots(pixels.before), length, roots(pixels.after));
    Ints in_row;
    std::memcpy(&in_row, pixels.in_row, sizeof in_row);
    const Floats zero = {};
    store(floats(pixels.x) + (in_row ? offset : zero),
          row + (in_row ? zero : offset),
          floats(pixels.gx) / length,
          floats(pixels.gy) / length,
          {points + first, count});
    for (std::size_t i = 0; i < count; ++i) lengths[first + i] = length[i];
  }
}

}  // namespace landmarkdb
