#include "engine/features/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr int kBits = 21;  // three axes in 64 bits
constexpr std::int64_t kMaxCells = std::int64_t{1} << kBits;
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;

// Points are float, cells are double: a point on the rim of the search sphere may round into the
// next cell. Widening the searched box by this share of the radius takes in all of them.
constexpr double kRimMargin = 1e-5;

}  // namespace

std::uint64_t pack_cell(std::int64_t x, std::int64_t y, std::int64_t z) {
  return (static_cast<std::uint64_t>(x) << (2 * kBits)) | (static_cast<std::uint64_t>(y) << kBits) |
         static_cast<std::uint64_t>(z);
}

std::array<std::int64_t, 3> unpack_cell(std::uint64_t key) {
  return {static_cast<std::int64_t>(key >> (2 * kBits)),
          static_cast<std::int64_t>((key >> kBits) & kMask),
          static_cast<std::int64_t>(key & kMask)};
}

CellKeys make_cell_keys(std::span<const Eigen::Vector3f> points, double cell_m) {
  if (!(cell_m > 0.0) || !std::isfinite(cell_m)) {
    throw Error(ErrorCode::kInvalidArgument,
                "cell size is " + std::to_string(cell_m) + " m, want a positive number");
  }
  CellKeys result;
  if (points.empty()) return result;
  Eigen::Vector3f min = points.front();
  Eigen::Vector3f max = points.front();
  for (const Eigen::Vector3f& p : points) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  result.min = min.cast<double>();
  const Eigen::Vector3d span = (max.cast<double>() - result.min) / cell_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(span[axis] < static_cast<double>(kMaxCells))) {
      throw Error(ErrorCode::kInvalidArgument,
                  "cloud spans " + std::to_string(span[axis]) + " cells of " +
                      std::to_string(cell_m) + " m, want at most " + std::to_string(kMaxCells));
    }
    result.last[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(span[axis]);
  }
  result.keys.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d c = (p.cast<double>() - result.min) / cell_m;
    result.keys.push_back(pack_cell(static_cast<std::int64_t>(c.x()),
                                    static_cast<std::int64_t>(c.y()),
                                    static_cast<std::int64_t>(c.z())));
  }
  return result;
}

CellGrid::CellGrid(std::span<const Eigen::Vector3f> points, double cell_m) : cell_m_(cell_m) {
  CellKeys cells = make_cell_keys(points, cell_m);
  min_ = cells.min;
  last_ = cells.last;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  sorted.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    sorted.emplace_back(cells.keys[i], static_cast<std::uint32_t>(i));
  }
  std::sort(sorted.begin(), sorted.end());
  order_.reserve(points.size());
  x_.reserve(points.size());
  y_.reserve(points.size());
  z_.reserve(points.size());
  for (const auto& [key, index] : sorted) {
    if (keys_.empty() || keys_.back() != key) {
      if (columns_.empty() || columns_.back() != key >> kBits) {
        columns_.push_back(key >> kBits);
        column_start_.push_back(static_cast<std::uint32_t>(keys_.size()));
      }
      keys_.push_back(key);
      start_.push_back(static_cast<std::uint32_t>(order_.size()));
    }
    order_.push_back(index);
    x_.push_back(points[index].x());
    y_.push_back(points[index].y());
    z_.push_back(points[index].z());
  }
  start_.push_back(static_cast<std::uint32_t>(order_.size()));
  column_start_.push_back(static_cast<std::uint32_t>(keys_.size()));
}

std::array<std::int64_t, 3> CellGrid::cell_of(const Eigen::Vector3d& p) const {
  std::array<std::int64_t, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double c = std::floor((p[i] - min_[i]) / cell_m_);
    cell[axis] =
        static_cast<std::int64_t>(std::clamp(c, -1.0, static_cast<double>(last_[axis]) + 1.0));
  }
  return cell;
}

std::uint32_t CellGrid::first_place(std::size_t column, std::uint64_t key) const {
  const auto begin = keys_.begin() + static_cast<std::ptrdiff_t>(column_start_[column]);
  const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(column_start_[column + 1]);
  return start_[static_cast<std::size_t>(std::lower_bound(begin, end, key) - keys_.begin())];
}

void CellGrid::runs(const Eigen::Vector3f& query, float radius_m, std::vector<Run>& out) const {
  out.clear();
  if (order_.empty()) return;
  const double reach = static_cast<double>(radius_m) * (1.0 + kRimMargin);
  const Eigen::Vector3d centre = query.cast<double>();
  std::array<std::int64_t, 3> low = cell_of(centre - Eigen::Vector3d::Constant(reach));
  std::array<std::int64_t, 3> high = cell_of(centre + Eigen::Vector3d::Constant(reach));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (low[axis] > last_[axis] || high[axis] < 0) return;
    low[axis] = std::max<std::int64_t>(low[axis], 0);
    high[axis] = std::min(high[axis], last_[axis]);
  }
  // Along y the columns lie side by side, and each is a cell or two of a surface: one search among
  // all columns for each x, and a short one in each column.
  for (std::int64_t cx = low[0]; cx <= high[0]; ++cx) {
    const std::uint64_t last = pack_cell(cx, high[1], 0) >> kBits;
    const auto first =
        std::lower_bound(columns_.begin(), columns_.end(), pack_cell(cx, low[1], 0) >> kBits);
    for (auto column = static_cast<std::size_t>(first - columns_.begin());
         column < columns_.size() && columns_[column] <= last;
         ++column) {
      const std::uint64_t key = columns_[column] << kBits;
      const Run run{first_place(column, key | static_cast<std::uint64_t>(low[2])),
                    first_place(column, (key | static_cast<std::uint64_t>(high[2])) + 1)};
      if (run.begin < run.end) out.push_back(run);
    }
  }
}

void CellGrid::within(const Eigen::Vector3f& query, float radius_m, std::vector<Found>& out) const {
  out.clear();
  std::vector<Run> near;
  runs(query, radius_m, near);
  const float limit = radius_m * radius_m;
  for (const Run& run : near) {
    for (std::uint32_t place = run.begin; place < run.end; ++place) {
      const float dx = x_[place] - query.x();
      const float dy = y_[place] - query.y();
      const float dz = z_[place] - query.z();
      const float squared = dx * dx + dy * dy + dz * dz;
      if (squared < limit) out.push_back({place, squared});
    }
  }
}

}  // namespace landmarkdb
