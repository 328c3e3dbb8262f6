#pragma once

#include <cstdint>

#include "engine/base/random.hpp"

namespace landmarkdb::datasets {

// A generator of its own for ray `index` of a sensor, so that noise does not depend on the order
// in which threads cast the rays.
inline Random ray_random(std::uint64_t seed, std::uint64_t index) {
  constexpr std::uint64_t kStep = 0xd1342543de82ef95ULL;  // odd: each index its own seed
  return Random(Random(seed ^ (index * kStep)).next());
}

}  // namespace landmarkdb::datasets
