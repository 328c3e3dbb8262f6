#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace landmarkdb {

// A block of 8 x 8 x 8 cells while it is filled, x fastest: what each cell names, and how far off
// that is.
struct BlockFill {
  static constexpr int kSide = 8;

  std::uint32_t* named = nullptr;            // kSide^3 numbers of surfels, 0: none
  float* nearest_m2 = nullptr;               // from the middle of each cell, squared
  float middle_m[3][kSide] = {};             // of the cells along each axis
  int first_cell[3] = {};                    // of the block, along each axis
  float inverse_cell = 0.0F;                 // cells a metre
  int reach = 0;                             // cells on each side that a surfel may be named in
  float most_m2 = 0.0F;                      // beyond which it is named in none
  std::span<const std::uint32_t> surfels{};  // in this order; of those as near the first one stays
};

// Names each surfel, `stride` floats a surfel of which the first three are its place, in the cells
// to which it is nearer than what they name. The same bytes on every instruction set.
using CellNamer = void (*)(const BlockFill& block, const float* surfels, std::size_t stride);
CellNamer cell_namer();

// That of one instruction set by name, "sse2", "avx2" or "avx512"; null where the machine lacks it.
CellNamer cell_namer(const char* instruction_set);

}  // namespace landmarkdb
