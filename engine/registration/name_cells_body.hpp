// No include guard: name_cells.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats`, `Cells` and `Numbers` are vectors of kLanes numbers that the
// compiler lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

// Squares of the distances along one axis; infinite in cells that the surfel may not be named in.
LANDMARKDB_INLINE Floats squared_within(Floats away, Cells cell, int low, int high) {
  const Floats none = Floats{} + std::numeric_limits<float>::infinity();
  return (cell < low) | (cell > high) ? none : away * away;
}

LANDMARKDB_INLINE void name_in_rows(
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
  constexpr int kPairs = kSide / kRows;  // of rows
  Floats middle_x;
  Cells cell_x;
  Floats middle_y[kPairs];
  Cells cell_y[kPairs];
  for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
    middle_x[lane] = block.middle_m[0][lane % kSide];
    cell_x[lane] = lane % kSide;
    for (int pair = 0; pair < kPairs; ++pair) {
      cell_y[pair][lane] = kRows * pair + lane / kSide;
      middle_y[pair][lane] = block.middle_m[1][kRows * pair + lane / kSide];
    }
  }
  for (const std::uint32_t surfel : block.surfels) {
    const float* p = surfels + surfel * stride;
    int low[3];
    int high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int home = round_down<int>(p[axis] * block.inverse_cell) - block.first_cell[axis];
      low[axis] = std::max(0, home - block.reach);
      high[axis] = std::min(kSide - 1, home + block.reach);
    }
    const Floats x_m2 = squared_within(middle_x - p[0], cell_x, low[0], high[0]);
    for (int pair = low[1] / kRows; pair <= high[1] / kRows; ++pair) {
      const Floats y_m2 = squared_within(middle_y[pair] - p[1], cell_y[pair], low[1], high[1]);
      for (int z = low[2]; z <= high[2]; ++z) {
        const float away_z = block.middle_m[2][z] - p[2];
        const auto rows = static_cast<std::size_t>((z * kSide + kRows * pair) * kSide);
        name_in_rows(x_m2 + (y_m2 + away_z * away_z),
                     block.most_m2,
                     surfel,
                     block.nearest_m2 + rows,
                     block.named + rows);
      }
    }
  }
}

#undef LANDMARKDB_INLINE
