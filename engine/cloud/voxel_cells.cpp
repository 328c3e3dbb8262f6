#include "engine/cloud/voxel_cells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "engine/base/error.hpp"
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

// Rounded down without a call, which SSE2 has no instruction for.
Cell cell_of(const Eigen::Vector3f& p, double cells_per_m) {
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const double number = static_cast<double>(p[axis]) * cells_per_m;
    if (!(std::abs(number) < kLargestCell)) refuse(cells_per_m, p[axis]);
    const auto cut = static_cast<std::int64_t>(number);
    cell[static_cast<std::size_t>(axis)] = cut - (static_cast<double>(cut) > number ? 1 : 0);
  }
  return cell;
}

struct Bounds {
  Cell low{std::numeric_limits<std::int64_t>::max(),
           std::numeric_limits<std::int64_t>::max(),
           std::numeric_limits<std::int64_t>::max()};
  Cell high{std::numeric_limits<std::int64_t>::min(),
            std::numeric_limits<std::int64_t>::min(),
            std::numeric_limits<std::int64_t>::min()};

  void add(const Cell& cell) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], cell[axis]);
      high[axis] = std::max(high[axis], cell[axis]);
    }
  }
  int bits(std::size_t axis) const {
    return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(high[axis]) -
                                           static_cast<std::uint64_t>(low[axis])));
  }
};

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
  Cell cell_of(std::uint64_t key) const {
    Cell cell = low_;
    for (int axis = 0, shift = 0; axis < 3; shift += bits_[at(axis++)]) {
      const int bits = bits_[at(axis)];
      if (bits == 0) continue;  // one cell only
      const std::uint64_t number = key >> shift & (~std::uint64_t{0} >> (64 - bits));
      cell[at(axis)] =
          static_cast<std::int64_t>(static_cast<std::uint64_t>(low_[at(axis)]) + number);
    }
    return cell;
  }

 private:
  static std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

  Cell low_;
  std::array<int, 3> bits_;
};

// One more point of a cell, behind those before it.
void append(const Cell& cell, std::uint32_t place, std::vector<VoxelCell>& cells) {
  if (!cells.empty() && cells.back().x == cell[0] && cells.back().y == cell[1] &&
      cells.back().z == cell[2]) {
    cells.back().end = place + 1;
  } else {
    cells.push_back({cell[0], cell[1], cell[2], place, place + 1});
  }
}

VoxelCells group_by_key(std::span<const Eigen::Vector3f> points,
                        std::vector<std::uint32_t> finite,
                        double cells_per_m,
                        const Bounds& bounds,
                        const RunContext& context) {
  const KeyLayout layout(bounds);
  std::vector<Keyed> items;
  items.reserve(finite.size());
  for (const std::uint32_t i : finite) {
    items.push_back({layout.key_of(cell_of(points[i], cells_per_m)), i});
  }
  sort_by_key(items, context);
  VoxelCells result;
  result.order = std::move(finite);
  for (std::uint32_t k = 0; k < items.size(); ++k) {
    result.order[k] = items[k].index;
    if (k > 0 && items[k].key == items[k - 1].key) {
      result.cells.back().end = k + 1;
    } else {
      append(layout.cell_of(items[k].key), k, result.cells);
    }
  }
  return result;
}

// For extents whose cell numbers do not fit one 64-bit key together.
VoxelCells group_by_compare(std::span<const Eigen::Vector3f> points,
                            std::vector<std::uint32_t> finite,
                            double cells_per_m) {
  std::vector<std::pair<Cell, std::uint32_t>> items;
  items.reserve(finite.size());
  for (const std::uint32_t i : finite) {
    const Cell cell = cell_of(points[i], cells_per_m);
    items.push_back({{cell[2], cell[1], cell[0]}, i});
  }
  std::sort(items.begin(), items.end());
  VoxelCells result;
  result.order = std::move(finite);
  for (std::uint32_t k = 0; k < items.size(); ++k) {
    const auto& [cell, index] = items[k];
    result.order[k] = index;
    append({cell[2], cell[1], cell[0]}, k, result.cells);
  }
  return result;
}

auto rank(const VoxelCell& cell) { return std::tie(cell.z, cell.y, cell.x); }

}  // namespace

VoxelCells group_by_voxel(std::span<const Eigen::Vector3f> points,
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
  std::vector<std::uint32_t> finite;
  finite.reserve(points.size());
  Bounds bounds;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % kStep == 0) context.check("voxels");
    if (!points[i].allFinite()) continue;
    finite.push_back(static_cast<std::uint32_t>(i));
    bounds.add(cell_of(points[i], cells_per_m));
  }
  if (finite.empty()) return {};
  const bool fits = bounds.bits(0) + bounds.bits(1) + bounds.bits(2) <= 64;
  return fits ? group_by_key(points, std::move(finite), cells_per_m, bounds, context)
              : group_by_compare(points, std::move(finite), cells_per_m);
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
