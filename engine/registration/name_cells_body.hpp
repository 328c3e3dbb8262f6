// No include guard: name_cells.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Numbers` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

LANDMARKDB_INLINE void name_in_row(
    Floats distance, float most, std::uint32_t surfel, float* nearest, std::uint32_t* named) {
  Floats near = load(nearest);
  Numbers names;
  __builtin_memcpy(&names, named, sizeof names);
  const auto closer = (distance < near) & (distance <= Floats{} + most);
  near = closer ? distance : near;
  names = closer ? Numbers{} + surfel : names;
  __builtin_memcpy(nearest, &near, sizeof near);
  __builtin_memcpy(named, &names, sizeof names);
}

void name_cells(const BlockFill& block, const float* surfels, std::size_t stride) {
  constexpr int kSide = BlockFill::kSide;
  for (const std::uint32_t surfel : block.surfels) {
    const float* p = surfels + surfel * stride;
    int low[3];
    int high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int home = round_down<int>(p[axis] * block.inverse_cell) - block.first_cell[axis];
      low[axis] = std::max(0, home - block.reach);
      high[axis] = std::min(kSide - 1, home + block.reach);
    }
    float along_x[kLanes];
    for (int x = 0; x < kSide; ++x) {
      const float away = block.middle_m[0][x] - p[0];
      along_x[x] = x < low[0] || x > high[0] ? std::numeric_limits<float>::infinity() : away * away;
    }
    const Floats row_m2 = load(along_x);
    for (int z = low[2]; z <= high[2]; ++z) {
      const float away_z = block.middle_m[2][z] - p[2];
      for (int y = low[1]; y <= high[1]; ++y) {
        const float away_y = block.middle_m[1][y] - p[1];
        const float beside = away_y * away_y + away_z * away_z;
        if (beside > block.most_m2) continue;
        const auto row = static_cast<std::size_t>((z * kSide + y) * kSide);
        name_in_row(
            row_m2 + beside, block.most_m2, surfel, block.nearest_m2 + row, block.named + row);
      }
    }
  }
}

#undef LANDMARKDB_INLINE
