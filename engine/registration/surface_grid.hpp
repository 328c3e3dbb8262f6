#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// A point of a surface and the unit normal there.
struct Surfel {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};

// What a grid takes: blocks of 8 x 8 x 8 cells and a surfel a point.
struct GridSize {
  std::size_t blocks = 0, points = 0;
  std::uint64_t bytes() const;
};

// "What surface is near here?", answered in a few nanoseconds: every cell within `reach` cells of
// the surface names the surfel nearest to the cell's centre. Sparse: blocks of 8 x 8 x 8 cells in a
// hash table.
//
// Built once, then immutable and thread-safe. A copy of the surfels is kept.
class SurfaceGrid {
 public:
  // Cells from zero that a point may lie out, for the numbers in the keys.
  static constexpr int kMostCells = (1 << 20) - 32;
  // 4 GiB: a place of 20 million points at its own spacing takes half of that. Far smaller cells
  // than the spacing take four blocks a point.
  static constexpr std::size_t kMostBlocks = std::size_t{1} << 21U;

  // One surfel for each point; `cell_m` is usually the voxel the points were thinned with. Throws
  // Error{kInvalidArgument} as size_for() does, and what `context.check` does.
  SurfaceGrid(std::span<const Eigen::Vector3f> points,
              std::span<const Eigen::Vector3f> normals,
              double cell_m,
              int reach_cells,
              const RunContext& context = {});

  // What that grid would take (a few blocks less in truth), counted without it. Throws
  // Error{kInvalidArgument}, field "voxel", with what is wanted and the limit for a grid of more
  // than kMostCells or kMostBlocks.
  static GridSize size_for(std::span<const Eigen::Vector3f> points,
                           double cell_m,
                           int reach_cells,
                           const RunContext& context = {});

  // The surfel near `p`, or nullptr when no surface is within reach of p's cell.
  const Surfel* near(const Eigen::Vector3f& p) const;

  float cell_m() const { return cell_m_; }
  // Beyond this distance from the surface near() finds nothing.
  float reach_m() const { return cell_m_ * static_cast<float>(reach_); }
  std::span<const Surfel> surfels() const { return surfels_; }
  std::size_t memory_bytes() const;

 private:
  static constexpr int kBlockBits = 3;
  static constexpr std::size_t kBlockCells = std::size_t{1} << (3 * kBlockBits);
  using Block = std::array<std::uint32_t, kBlockCells>;  // surfel index + 1; 0: none
  using Cell = Eigen::Vector3i;

  Cell cell_of(const Eigen::Vector3f& p) const;
  static std::uint64_t key_of(const Cell& block);
  std::size_t find_slot(std::uint64_t key) const;
  Block& block_at(std::uint64_t key);
  void grow_table();
  void insert_around(std::uint32_t surfel);

  float cell_m_;
  float inverse_cell_;
  int reach_;
  std::vector<Surfel> surfels_;
  // Open addressing: keys_[slot] with blocks_[slots_[slot]]; kNoKey marks a free slot.
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> slots_;
  std::vector<Block> blocks_;
};

}  // namespace landmarkdb
