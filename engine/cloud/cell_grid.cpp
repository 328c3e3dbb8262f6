#include "engine/cloud/cell_grid.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/round_down.hpp"
#include "engine/cloud/sort_by_key.hpp"

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
  std::vector<Keyed> sorted;
  sorted.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    sorted.push_back({cells.keys[i], static_cast<std::uint32_t>(i)});
  }
  sort_by_key(sorted);
  order_.reserve(points.size());
  x_.reserve(points.size());
  y_.reserve(points.size());
  z_.reserve(points.size());
  for (const auto& [key, index] : sorted) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      start_.push_back(static_cast<std::uint32_t>(order_.size()));
    }
    order_.push_back(index);
    x_.push_back(points[index].x());
    y_.push_back(points[index].y());
    z_.push_back(points[index].z());
  }
  start_.push_back(static_cast<std::uint32_t>(order_.size()));
  index_columns();
}

void CellGrid::index_columns() {
  constexpr std::int64_t kColumnsAPoint = 4;
  constexpr std::int64_t kAlways = 1 << 16;
  const std::int64_t along_y = last_[1] + 1;
  const std::int64_t columns = (last_[0] + 1) * along_y;  // at most 2^42
  if (columns > std::max(kAlways, kColumnsAPoint * static_cast<std::int64_t>(order_.size()))) {
    return;
  }
  columns_.reserve(static_cast<std::size_t>(columns) + 1);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const auto [x, y, z] = unpack_cell(keys_[i]);
    const auto column = static_cast<std::size_t>(x * along_y + y);
    while (columns_.size() <= column) columns_.push_back(static_cast<std::uint32_t>(i));
  }
  columns_.resize(static_cast<std::size_t>(columns) + 1, static_cast<std::uint32_t>(keys_.size()));
}

std::array<std::int64_t, 3> CellGrid::cell_of(const Eigen::Vector3d& p) const {
  std::array<std::int64_t, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double c = (p[i] - min_[i]) / cell_m_;
    cell[axis] =
        round_down<std::int64_t>(std::clamp(c, -1.0, static_cast<double>(last_[axis]) + 1.0));
  }
  return cell;
}

CellGrid::Run CellGrid::column_run(std::int64_t cx,
                                   std::int64_t cy,
                                   std::int64_t cz_low,
                                   std::int64_t cz_high) const {
  if (cz_low > cz_high) return {};
  auto first = keys_.begin();
  auto last = keys_.end();
  if (!columns_.empty()) {
    const auto column = static_cast<std::size_t>(cx * (last_[1] + 1) + cy);
    last = first + columns_[column + 1];
    first += columns_[column];
  }
  first = std::lower_bound(first, last, pack_cell(cx, cy, cz_low));
  const std::uint64_t end = pack_cell(cx, cy, cz_high);
  const auto after = columns_.empty() ? std::upper_bound(first, last, end)
                                      : std::find_if(first, last, [&](auto k) { return k > end; });
  return {start_[static_cast<std::size_t>(first - keys_.begin())],
          start_[static_cast<std::size_t>(after - keys_.begin())]};
}

void CellGrid::runs(const Eigen::Vector3f& query, float radius_m, std::vector<Run>& out) const {
  out.clear();
  if (order_.empty()) return;
  const double reach = static_cast<double>(radius_m) * (1.0 + kRimMargin);
  const Eigen::Vector3d centre = query.cast<double>();
  const std::array<std::int64_t, 3> low = cell_of(centre - Eigen::Vector3d::Constant(reach));
  const std::array<std::int64_t, 3> high = cell_of(centre + Eigen::Vector3d::Constant(reach));
  const auto first = [&](std::size_t axis) { return std::max<std::int64_t>(low[axis], 0); };
  const auto last = [&](std::size_t axis) { return std::min(high[axis], last_[axis]); };
  // From the centre to the nearest of the cells `cell` of this axis.
  const auto distance = [&](std::size_t axis, std::int64_t cell) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double from = min_[i] + static_cast<double>(cell) * cell_m_;
    return std::max({0.0, from - centre[i], centre[i] - (from + cell_m_)});
  };
  const double squared = reach * reach;
  for (std::int64_t cx = first(0); cx <= last(0); ++cx) {
    const double dx = distance(0, cx);
    for (std::int64_t cy = first(1); cy <= last(1); ++cy) {
      const double dy = distance(1, cy);
      const double left = squared - dx * dx - dy * dy;
      if (left < 0.0) continue;
      const double half = std::sqrt(left);
      const auto cz = [&](double z) { return round_down<std::int64_t>((z - min_.z()) / cell_m_); };
      const Run run = column_run(cx,
                                 cy,
                                 std::max(cz(centre.z() - half), first(2)),
                                 std::min(cz(centre.z() + half), last(2)));
      if (run.begin < run.end) out.push_back(run);
    }
  }
}

CellGrid::Ball CellGrid::ball_around(const Run& places) const {
  Ball ball;
  const auto count = static_cast<float>(places.end - places.begin);
  for (std::uint32_t place = places.begin; place < places.end; ++place) {
    ball.centre += point(place) / count;
  }
  for (std::uint32_t place = places.begin; place < places.end; ++place) {
    ball.radius_m = std::max(ball.radius_m, (point(place) - ball.centre).norm());
  }
  return ball;
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
