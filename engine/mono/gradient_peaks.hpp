#pragma once

#include <cstdint>
#include <span>

#include "engine/mono/gradient_rows.hpp"
#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// The points of row `y` where mark_maxima() found the gradient largest, to a fraction of a pixel:
// by the parabola through its length there and at the neighbours along the axis it is nearer to.
// One point and one length, of the filter's units, a column.
void place_peaks(const GradientRows& rows,
                 std::uint32_t y,
                 std::span<const std::int32_t> columns,
                 EdgePoint* points,
                 float* lengths);

}  // namespace landmarkdb
