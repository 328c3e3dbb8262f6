#include "engine/registration/surface_grid.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>
#include <unordered_set>

#include "engine/base/error.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kStep = 4096;  // points between two looks at the stop token
// Points whose blocks are filled together: enough to fill each block once in most clouds, and some
// ten megabytes while that is done.
constexpr std::size_t kAtATime = std::size_t{1} << 18U;

// Throws when a point lies more cells from zero than a key can hold.
void check_extent(std::span<const Eigen::Vector3f> points, double cell_m) {
  double farthest_m = 0.0;
  for (const Eigen::Vector3f& p : points) {
    farthest_m = std::max(farthest_m, static_cast<double>(p.cwiseAbs().maxCoeff()));
  }
  const double cells = farthest_m / cell_m;
  if (cells < SurfaceGrid::kMostCells) return;
  std::ostringstream text;
  text << "a voxel of " << cell_m << " m is too small for points " << farthest_m
       << " m out: that is " << cells << " cells, the limit is " << SurfaceGrid::kMostCells;
  throw Error(ErrorCode::kInvalidArgument, text.str(), "voxel");
}

}  // namespace

void SurfaceGrid::check_blocks(std::size_t blocks,
                               std::size_t done,
                               std::size_t points,
                               double cell_m) {
  if (blocks <= kMostBlocks) return;
  const double share = static_cast<double>(std::max<std::size_t>(done, 1)) /
                       static_cast<double>(std::max<std::size_t>(points, 1));
  std::ostringstream text;
  text << "a voxel of " << cell_m << " m is too small for this cloud: the grid of its " << points
       << " points would take about " << static_cast<double>(blocks) / share
       << " blocks of 2 KiB, the limit is " << kMostBlocks;
  throw Error(ErrorCode::kInvalidArgument, text.str(), "voxel");
}

std::uint64_t GridSize::bytes() const {
  constexpr std::uint64_t kBlockBytes = 2048 + 24;  // and its place in a half-full table
  return kBlockBytes * blocks + sizeof(Surfel) * points;
}

GridSize SurfaceGrid::size_for(std::span<const Eigen::Vector3f> points,
                               double cell_m,
                               int reach_cells,
                               const RunContext& context) {
  check_extent(points, cell_m);
  const auto inverse_cell = static_cast<float>(1.0 / cell_m);
  std::unordered_set<std::uint64_t> blocks;
  Cell low_before = Cell::Constant(kLimit), high_before = low_before;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kStep == 0) context.check("grid");
    const Cell home = (points[i].array() * inverse_cell).floor().cast<int>();
    const Cell low = (home.array() - reach_cells).unaryExpr([](int v) { return v >> kBlockBits; });
    const Cell high = (home.array() + reach_cells).unaryExpr([](int v) { return v >> kBlockBits; });
    if (low == low_before && high == high_before) continue;  // neighbours come together
    low_before = low;
    high_before = high;
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) blocks.insert(key_of(Cell(x, y, z)));
      }
    }
    check_blocks(blocks.size(), i + 1, points.size(), cell_m);
  }
  return {blocks.size(), points.size()};
}

SurfaceGrid::SurfaceGrid(std::span<const Eigen::Vector3f> points,
                         std::span<const Eigen::Vector3f> normals,
                         double cell_m,
                         int reach_cells,
                         const RunContext& context)
    : cell_m_(static_cast<float>(cell_m)),
      inverse_cell_(static_cast<float>(1.0 / cell_m)),
      reach_(reach_cells) {
  assert(points.size() == normals.size() && "one normal a point");
  assert(cell_m > 0.0 && reach_cells >= 0 && "a grid needs a cell size");
  check_extent(points, cell_m);
  Cell first = Cell::Constant(kLimit);
  Cell last = Cell::Constant(-kLimit);
  for (const Eigen::Vector3f& point : points) {
    const Cell cell = cell_of(point);
    first = first.cwiseMin(block_of((cell.array() - reach_).matrix()));
    last = last.cwiseMax(block_of((cell.array() + reach_).matrix()));
  }
  make_table(first, last);
  blocks_.emplace_back().fill(0);
  surfels_.reserve(points.size() + 1);
  surfels_.push_back({Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()});
  for (std::size_t i = 0; i < points.size(); ++i) surfels_.push_back({points[i], normals[i]});
  std::vector<Cell> places{Cell::Zero()};
  for (std::size_t i = 0; i < points.size(); i += kAtATime) {
    const auto end = static_cast<std::uint32_t>(std::min(i + kAtATime, points.size()));
    insert(static_cast<std::uint32_t>(i) + 1, end + 1, places, context);
  }
}

// A table where it is small, even against the surfels; otherwise an empty hash table.
void SurfaceGrid::make_table(const Cell& first, const Cell& last) {
  constexpr double kMostOfTable = 1 << 22;  // 16 MiB
  const Eigen::Array3d size = (last - first).cast<double>().array() + 1.0;
  if ((size > 0.0).all() && size.prod() <= kMostOfTable) {
    table_first_ = first;
    table_size_ = size.cast<int>().matrix();
    table_.assign(1 + static_cast<std::size_t>(size.prod()), kNoBlock);
    return;
  }
  constexpr std::size_t kFirstSlots = 1024;
  keys_.assign(kFirstSlots, kNoKey);
  slots_.assign(kFirstSlots, 0);
}

std::uint32_t SurfaceGrid::number_of(const Cell& block, std::vector<Cell>& places) {
  std::uint32_t* number = nullptr;
  if (!table_.empty()) {
    number = &table_[table_index(block - table_first_)];
    if (*number != kNoBlock) return *number;
  } else {
    const std::uint64_t key = key_of(block);
    if (2 * (places.size() + 1) > keys_.size()) grow_table();
    const std::size_t slot = find_slot(key);
    if (keys_[slot] == key) return slots_[slot];
    keys_[slot] = key;
    number = &slots_[slot];
  }
  *number = static_cast<std::uint32_t>(places.size());
  places.push_back(block);
  return *number;
}

void SurfaceGrid::grow_table() {
  std::vector<std::uint64_t> old_keys(2 * keys_.size(), kNoKey);
  std::vector<std::uint32_t> old_slots(2 * slots_.size(), 0);
  old_keys.swap(keys_);
  old_slots.swap(slots_);
  for (std::size_t i = 0; i < old_keys.size(); ++i) {
    if (old_keys[i] == kNoKey) continue;
    const std::size_t slot = find_slot(old_keys[i]);
    keys_[slot] = old_keys[i];
    slots_[slot] = old_slots[i];
  }
}

std::size_t SurfaceGrid::memory_bytes() const {
  return blocks_.size() * sizeof(Block) + table_.size() * sizeof(std::uint32_t) +
         keys_.size() * (sizeof(std::uint64_t) + sizeof(std::uint32_t)) +
         surfels_.size() * sizeof(Surfel);
}

}  // namespace landmarkdb
