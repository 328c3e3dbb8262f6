#include "engine/cloud/voxel_cells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/base/round_down.hpp"
#include "engine/cloud/sort_by_key.hpp"

namespace landmarkdb {
namespace {

using Cell = std::array<std::int64_t, 3>;

constexpr std::size_t kStep = 65'536;    // points between two looks at the stop token
constexpr double kLargestCell = 0x1p62;  // keeps differences of cell numbers inside 64 bits

[[noreturn]] void refuse(double cells_per_m, float coordinate) {
  throw Error(ErrorCode::kInvalidArgument,
              "voxel size of " + std::to_string(1.0 / cells_per_m) +
                  " m: too small for points as far out as " + std::to_string(coordinate) + " m");
}

Cell cell_of(const Eigen::Vector3f& p, double cells_per_m) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double number = static_cast<double>(p[axis]) * cells_per_m;
    if (!(std::abs(number) < kLargestCell)) refuse(cells_per_m, p[axis]);
    cell[static_cast<std::size_t>(axis)] = round_down<std::int64_t>(number);
  }
  return cell;
}

struct Bounds {
  Cell low{};
  Cell high{};

  int bits(std::size_t axis) const {
    return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(high[axis]) -
                                           static_cast<std::uint64_t>(low[axis])));
  }
  int bits() const { return bits(0) + bits(1) + bits(2); }
};

// Bits of the numbers below `count`.
int index_bits(std::size_t count) { return static_cast<int>(std::bit_width(count - 1)); }

// A cell's numbers, counted from the lowest, one above the other in 64 bits, x lowest.
class KeyLayout {
 public:
  // The numbers must fit 64 bits together.
  explicit KeyLayout(const Bounds& bounds)
      : low_(bounds.low), bits_{bounds.bits(0), bounds.bits(1), bounds.bits(2)} {}

  std::uint64_t key_of(const Cell& cell) const {
    std::uint64_t key = 0;
    for (int axis = 0, shift = 0; axis < 3; shift += bits_[at(axis++)]) {
      const std::uint64_t number =
          static_cast<std::uint64_t>(cell[at(axis)]) - static_cast<std::uint64_t>(low_[at(axis)]);
      // A shift by 64 would be undefined, and means that the axes above have one cell only.
      if (shift < 64) key |= number << shift;
    }
    return key;
  }

 private:
  static std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

  Cell low_;
  std::array<int, 3> bits_;
};

// Makes cells of the items' runs of one key.
template <typename Item, typename IndexOf, typename KeyOf>
VoxelRuns runs_of_sorted(const std::vector<Item>& items,
                         const IndexOf& index_of,
                         const KeyOf& key_of,
                         const RunContext& context) {
  VoxelRuns runs;
  runs.order.reserve(items.size());
  for (std::uint32_t k = 0; k < items.size(); ++k) {
    if (k % kStep == 0) context.check("voxels");
    runs.order.push_back(index_of(items[k]));
    if (k == 0 || key_of(items[k]) != key_of(items[k - 1])) runs.first.push_back(k);
  }
  runs.first.push_back(static_cast<std::uint32_t>(items.size()));
  return runs;
}

// Each word is a cell's key above a point's index.
VoxelRuns group_by_word(std::span<const Eigen::Vector3f> points,
                        std::vector<std::uint32_t> finite,
                        double cells_per_m,
                        const KeyLayout& layout,
                        const RunContext& context) {
  const int shift = index_bits(points.size());
  std::vector<std::uint64_t> words(finite.size());
  parallel_chunks(finite.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint64_t key = layout.key_of(cell_of(points[finite[k]], cells_per_m));
      words[k] = (key << shift) | finite[k];
    }
  });
  finite = {};  // what follows takes the most memory
  sort_words(words, shift, context);
  return runs_of_sorted(
      words,
      [&](std::uint64_t word) {
        return static_cast<std::uint32_t>(word & ((std::uint64_t{1} << shift) - 1));
      },
      [&](std::uint64_t word) { return word >> shift; },
      context);
}

// For extents whose cell numbers and a point's index do not fit 64 bits together.
VoxelRuns group_by_key(std::span<const Eigen::Vector3f> points,
                       std::vector<std::uint32_t> finite,
                       double cells_per_m,
                       const KeyLayout& layout,
                       const RunContext& context) {
  std::vector<Keyed> items(finite.size());
  parallel_chunks(finite.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      items[k] = {layout.key_of(cell_of(points[finite[k]], cells_per_m)), finite[k]};
    }
  });
  finite = {};
  sort_by_key(items, context);
  return runs_of_sorted(
      items,
      [](const Keyed& item) { return item.index; },
      [](const Keyed& item) { return item.key; },
      context);
}

// For extents whose cell numbers alone do not.
VoxelRuns group_by_compare(std::span<const Eigen::Vector3f> points,
                           const std::vector<std::uint32_t>& finite,
                           double cells_per_m,
                           const RunContext& context) {
  struct Item {
    Cell key;  // z first
    std::uint32_t index;
    auto operator<=>(const Item&) const = default;
  };
  std::vector<Item> items;
  items.reserve(finite.size());
  for (const std::uint32_t i : finite) {
    const Cell cell = cell_of(points[i], cells_per_m);
    items.push_back({{cell[2], cell[1], cell[0]}, i});
  }
  std::sort(items.begin(), items.end());
  return runs_of_sorted(
      items,
      [](const Item& item) { return item.index; },
      [](const Item& item) { return item.key; },
      context);
}

auto rank(const VoxelCell& cell) { return std::tie(cell.z, cell.y, cell.x); }

}  // namespace

VoxelRuns find_voxel_runs(std::span<const Eigen::Vector3f> points,
                          double edge_m,
                          const RunContext& context) {
  if (!(edge_m > 0.0) || !std::isfinite(edge_m) || !std::isfinite(1.0 / edge_m)) {
    throw Error(ErrorCode::kInvalidArgument,
                "voxel size is " + std::to_string(edge_m) + " m, want a positive length");
  }
  if (points.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::kResourceExhausted,
                "voxel grid: " + std::to_string(points.size()) + " points, want below 2^32");
  }
  const double cells_per_m = 1.0 / edge_m;
  std::vector<std::uint32_t> finite(points.size());
  std::size_t count = 0;
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kStep == 0) context.check("voxels");
    if (!points[i].allFinite()) continue;
    finite[count++] = static_cast<std::uint32_t>(i);
    box.extend(points[i]);
  }
  if (count == 0) return {};
  finite.resize(count);
  // A point further out is in no lower a cell.
  const Bounds bounds{cell_of(box.min(), cells_per_m), cell_of(box.max(), cells_per_m)};
  if (bounds.bits() > 64) return group_by_compare(points, finite, cells_per_m, context);
  const bool fits_with_index = bounds.bits() + index_bits(points.size()) <= 64;
  return (fits_with_index ? group_by_word : group_by_key)(
      points, std::move(finite), cells_per_m, KeyLayout(bounds), context);
}

VoxelCells group_by_voxel(std::span<const Eigen::Vector3f> points,
                          double edge_m,
                          const RunContext& context) {
  VoxelRuns runs = find_voxel_runs(points, edge_m, context);
  const double cells_per_m = 1.0 / edge_m;
  VoxelCells result;
  result.cells.resize(runs.cells());
  parallel_chunks(runs.cells(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Cell cell = cell_of(points[runs.points_of(c)[0]], cells_per_m);
      result.cells[c] = {cell[0], cell[1], cell[2], runs.first[c], runs.first[c + 1]};
    }
  });
  result.order = std::move(runs.order);
  return result;
}

std::span<const VoxelCell> find_row(const VoxelCells& cells,
                                    std::int64_t x_first,
                                    std::int64_t x_last,
                                    std::int64_t y,
                                    std::int64_t z) {
  const VoxelCell first{x_first, y, z, 0, 0};
  const auto begin = std::lower_bound(
      cells.cells.begin(), cells.cells.end(), first, [](const VoxelCell& a, const VoxelCell& b) {
        return rank(a) < rank(b);
      });
  const VoxelCell last{x_last, y, z, 0, 0};
  auto end = begin;
  while (end != cells.cells.end() && rank(*end) <= rank(last)) ++end;
  return {begin, end};
}

}  // namespace landmarkdb
