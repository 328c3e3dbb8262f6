#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "engine/base/round_down.hpp"
#include "engine/base/run_context.hpp"

namespace landmarkdb {

// A point of a surface and the unit normal there; within one line of the cache, as kernels load it
// at once.
struct alignas(32) Surfel {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};
static_assert(sizeof(Surfel) == 32);

// What a grid takes: blocks of 8 x 8 x 8 cells and a surfel a point.
struct GridSize {
  std::size_t blocks = 0, points = 0;
  std::uint64_t bytes() const;
};

// "What surface is near here?", answered in a few nanoseconds: every cell within `reach` cells of
// the surface names the surfel nearest to the cell's centre. Sparse: blocks of 8 x 8 x 8 cells,
// found through a table of the box that holds them, or a hash table where that would be too large.
//
// Built once, on the threads of the context, then immutable and thread-safe. A copy of the surfels
// is kept.
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
  const Surfel* near(const Eigen::Vector3f& p) const {
    const std::uint32_t stored = stored_at(p);
    return stored == 0 ? nullptr : &surfels_[stored];
  }

  // The same, but a surfel without a normal (all zero) where there is none: for loops that weigh
  // what they find by its normal and would rather not branch.
  const Surfel& near_or_none(const Eigen::Vector3f& p) const { return surfels_[stored_at(p)]; }

  // The number of the surfel near `p` in the array of a TableView; 0: none.
  std::uint32_t stored_at(const Eigen::Vector3f& p) const {
    const Cell cell = cell_of(p);
    return find_block(block_of(cell))[cell_in_block(cell)];
  }

  // What loops over many points look cells up in themselves. A point's cell is its coordinates
  // times inverse_cell, rounded down and at most kFarthestCell from zero; its block is the cell
  // shifted right by kBlockBits, which is number 1 + x + size.x (y + size.y z) of `block_of`
  // counted from `first`, and number 0 outside; the cell's surfel is surfels[cells[block *
  // kBlockCells + low bits of the cell, x fastest]], surfels[0] one without a normal. `block_of` is
  // null where the blocks are found by hash: there is stored_at() then.
  struct TableView {
    const std::uint32_t* block_of;
    const std::uint32_t* cells;
    const Surfel* surfels;
    std::array<int, 3> first, size;
    float inverse_cell;
  };
  TableView table_view() const {
    return {table_.empty() ? nullptr : table_.data(),
            blocks_.front().data(),
            surfels_.data(),
            {table_first_.x(), table_first_.y(), table_first_.z()},
            {table_size_.x(), table_size_.y(), table_size_.z()},
            inverse_cell_};
  }
  static constexpr int kBlockBits = 3;
  static constexpr std::size_t kBlockCells = std::size_t{1} << (3 * kBlockBits);
  static constexpr float kFarthestCell = (1 << 20) - 16;

  float cell_m() const { return cell_m_; }
  // Beyond this distance from the surface near() finds nothing.
  float reach_m() const { return cell_m_ * static_cast<float>(reach_); }
  std::span<const Surfel> surfels() const { return std::span(surfels_).subspan(1); }
  std::size_t memory_bytes() const;

 private:
  using Block = std::array<std::uint32_t, kBlockCells>;  // index into surfels_; 0: none
  using Cell = Eigen::Vector3i;
  static constexpr int kBlockSide = 1 << kBlockBits;
  static constexpr int kLimit = 1 << 20;  // cells a side: 21 bits and a sign in each key
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  static constexpr std::uint32_t kNoBlock = 0;  // the first block is empty

  // Clamped before the cast: a float beyond int is undefined behaviour, and nothing is stored out
  // there.
  static int cell_on_axis(float scaled) {
    const float clamped = std::min(kFarthestCell, std::max(-kFarthestCell, scaled));  // NaN: far
    return round_down<int>(clamped);
  }
  Cell cell_of(const Eigen::Vector3f& p) const {
    return {cell_on_axis(p.x() * inverse_cell_),
            cell_on_axis(p.y() * inverse_cell_),
            cell_on_axis(p.z() * inverse_cell_)};
  }
  static Cell block_of(const Cell& cell) {
    return {cell.x() >> kBlockBits, cell.y() >> kBlockBits, cell.z() >> kBlockBits};
  }
  static std::size_t cell_in_block(const Cell& cell) {
    constexpr int kMask = (1 << kBlockBits) - 1;
    return static_cast<std::size_t>((cell.x() & kMask) | ((cell.y() & kMask) << kBlockBits) |
                                    ((cell.z() & kMask) << (2 * kBlockBits)));
  }
  static std::uint64_t key_of(const Cell& block) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + kLimit) & 0x1fffffU; };
    return part(block.x()) | (part(block.y()) << 21U) | (part(block.z()) << 42U);
  }
  std::size_t find_slot(std::uint64_t key) const {
    constexpr std::uint64_t kHashFactor = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio (Knuth 6.4)
    const std::size_t mask = keys_.size() - 1;
    std::size_t slot = static_cast<std::size_t>((key * kHashFactor) >> 20U) & mask;
    while (keys_[slot] != key && keys_[slot] != kNoKey) slot = (slot + 1) & mask;
    return slot;
  }
  std::size_t table_index(const Cell& at) const {
    return 1 +
           static_cast<std::size_t>(at.x() + table_size_.x() * (at.y() + table_size_.y() * at.z()));
  }
  // The block's cells; the empty block's where there is none.
  const std::uint32_t* find_block(const Cell& block) const {
    std::uint32_t number = kNoBlock;
    if (!table_.empty()) {
      const Cell at = block - table_first_;
      const bool inside = (at.array() >= 0).all() && (at.array() < table_size_.array()).all();
      number = inside ? table_[table_index(at)] : kNoBlock;
    } else {
      const std::uint64_t key = key_of(block);
      const std::size_t slot = find_slot(key);
      number = keys_[slot] == key ? slots_[slot] : kNoBlock;
    }
    return blocks_[number].data();
  }
  float middle(int cell) const { return (static_cast<float>(cell) + 0.5F) * cell_m_; }
  // Throws where there are more than kMostBlocks after `done` of the `points`.
  static void check_blocks(std::size_t blocks, std::size_t done, std::size_t points, double cell_m);
  // The block's number, a new one where it had none; `places` has the block of each number.
  std::uint32_t number_of(const Cell& block, std::vector<Cell>& places);
  void grow_table();
  void make_table(const Cell& first, const Cell& last);

  // What names surfels in the cells near them (fill_surface_grid.cpp).
  float most_squared() const;
  template <typename Visit>
  void visit_blocks(const Eigen::Vector3f& p, const Visit& visit) const;
  void insert(std::uint32_t first,
              std::uint32_t end,
              std::vector<Cell>& places,
              const RunContext& context);
  void measure_block(const Block& block,
                     const Cell& low,
                     std::array<float, kBlockCells>& nearest) const;
  void fill_block(Block& block,
                  const Cell& place,
                  bool is_new,
                  std::span<const std::uint32_t> surfels) const;

  float cell_m_;
  float inverse_cell_;
  int reach_;
  std::vector<Surfel> surfels_;  // the first is none
  // Open addressing: keys_[slot] with blocks_[slots_[slot]]; kNoKey marks a free slot.
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> slots_;
  // kNoBlock, then the number of each block of the box from table_first_ on, x fastest, kNoBlock
  // where there is none; empty where the box is too large.
  std::vector<std::uint32_t> table_;
  Cell table_first_ = Cell::Zero();
  Cell table_size_ = Cell::Zero();
  std::vector<Block> blocks_;  // the first is empty
};

}  // namespace landmarkdb
