#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// The points of one cubic cell of a lattice through the cloud's zero.
struct VoxelCell {
  std::int64_t x = 0, y = 0, z = 0;
  std::uint32_t begin = 0, end = 0;  // its points in VoxelCells::order
};

// Points grouped by cell. Cells come by ascending (z, y, x); within a cell the points keep their
// order. Points that are not finite are in no cell.
struct VoxelCells {
  std::vector<std::uint32_t> order;  // indices of points
  std::vector<VoxelCell> cells;
};

// The same without the cells' numbers, in an eighth of the memory: cell c holds the points
// order[first[c]] .. order[first[c + 1] - 1].
struct VoxelRuns {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> first;  // one more than cells, unless there are none

  std::size_t cells() const { return first.empty() ? 0 : first.size() - 1; }
  std::span<const std::uint32_t> points_of(std::size_t cell) const {
    return std::span(order).subspan(first[cell], first[cell + 1] - first[cell]);
  }
};

// Throws Error{kInvalidArgument} for an edge that is not positive and finite, or so small that the
// cell numbers of these points would not fit 64 bits. Cost: a radix sort of 64-bit keys, unless the
// extent needs wider ones. Throws what `context.check` does.
VoxelRuns find_voxel_runs(std::span<const Eigen::Vector3f> points,
                          double edge_m,
                          const RunContext& context = {});

// find_voxel_runs, and the number of each cell.
VoxelCells group_by_voxel(std::span<const Eigen::Vector3f> points,
                          double edge_m,
                          const RunContext& context = {});

// The cells that are not empty of x_first .. x_last in the row of this y and z.
std::span<const VoxelCell> find_row(const VoxelCells& cells,
                                    std::int64_t x_first,
                                    std::int64_t x_last,
                                    std::int64_t y,
                                    std::int64_t z);

// Calls `visit` with the cell and those of the 26 around it that are not empty, by ascending
// (z, y, x), until one call returns true; whether one did.
template <typename Visit>
bool any_around(const VoxelCells& cells, const VoxelCell& cell, const Visit& visit) {
  for (int row = 0; row < 9; ++row) {
    const std::int64_t y = cell.y + row % 3 - 1;
    const std::int64_t z = cell.z + row / 3 - 1;
    for (const VoxelCell& one : find_row(cells, cell.x - 1, cell.x + 1, y, z)) {
      if (visit(one)) return true;
    }
  }
  return false;
}

}  // namespace landmarkdb
