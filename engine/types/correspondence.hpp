#pragma once

#include <cstdint>

namespace landmarkdb {

// A pair handed to a solver: indices of a keypoint of the query and of one of the target (the
// searched entry), and the distance of their descriptors.
struct Correspondence {
  std::uint32_t query = 0;
  std::uint32_t target = 0;
  float distance = 0.0F;
};

}  // namespace landmarkdb
