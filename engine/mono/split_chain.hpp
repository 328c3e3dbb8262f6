#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// Splits chains into straight pieces (Ramer 1972, Douglas and Peucker 1973), one after the other in
// the same memory: an image has a thousand.
class ChainSplitter {
 public:
  // The indices of the points at the pieces' ends, ascending, both ends of the chain among them,
  // until the next call. No point of a piece is farther than `tolerance_px` from the straight line
  // between its ends. Needs at least one point.
  std::span<const std::size_t> split(std::span<const EdgePoint> points, double tolerance_px);

 private:
  std::vector<std::size_t> splits_;
  std::vector<std::size_t> open_;  // right ends still to be reached
};

}  // namespace landmarkdb
