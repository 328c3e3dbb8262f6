#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// Where a chain is split into straight pieces (Ramer 1972, Douglas and Peucker 1973): the indices
// of the points at their ends, ascending, both ends of the chain among them. No point of a piece is
// farther than `tolerance_px` from the straight line between its ends. Needs at least one point.
std::vector<std::size_t> split_chain(std::span<const EdgePoint> points, double tolerance_px);

}  // namespace landmarkdb
