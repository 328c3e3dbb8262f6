#include "engine/cloud/reach.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/cloud/voxel_cells.hpp"

namespace landmarkdb {
namespace {

// Middle of the values, and half the width of what holds the middle half of them.
struct Bulk {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double extent_m = 0.0;
};

double take_median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Bulk measure_bulk(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kLooked = 10'000;  // a median needs no more
  const std::size_t step = points.size() / kLooked + 1;
  Bulk bulk;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < points.size(); i += step) {
      if (points[i].allFinite()) values.push_back(points[i][axis]);
    }
    if (values.empty()) return bulk;
    bulk.centre[axis] = take_median(values);
    for (double& value : values) value = std::abs(value - bulk.centre[axis]);
    half[axis] = take_median(values);
  }
  bulk.extent_m = 2.0 * half.norm();
  return bulk;
}

constexpr double kShell = 2.0;   // how much further out each shell begins
constexpr double kBeside = 1.2;  // beyond a shell's ends, for company

// Whether the cell and the 26 around it hold so many points.
bool holds_around(const VoxelCells& cells, const VoxelCell& own, std::size_t points) {
  std::size_t count = 0;
  return any_around(cells, own, [&](const VoxelCell& cell) {
    count += cell.end - cell.begin;
    return count >= points;
  });
}

double distance_to(const Eigen::Vector3f& p, const Eigen::Vector3d& centre) {
  return (p.cast<double>() - centre).norm();
}

// Adds to `alone` what of the points kept[far[..]] lies from `from_m` to twice as far out and has
// hardly another around; those a little nearer or further count as company.
void find_alone(std::span<const Eigen::Vector3f> points,
                const Eigen::Vector3d& centre,
                double from_m,
                const std::vector<std::uint32_t>& kept,
                const std::vector<std::uint32_t>& far,
                std::vector<std::uint32_t>& alone,
                const RunContext& context) {
  constexpr double kAround = 0.05;  // of the way
  constexpr std::size_t kFewest = 4;
  std::vector<Eigen::Vector3f> shell;
  std::vector<std::uint32_t> place;  // in `kept`
  for (const std::uint32_t k : far) {
    const Eigen::Vector3f& p = points[kept[k]];
    const double away = distance_to(p, centre);
    if (away < from_m / kBeside || away >= kBeside * kShell * from_m) continue;
    shell.push_back(p);
    place.push_back(k);
  }
  const VoxelCells cells = group_by_voxel(shell, kAround * from_m, context);
  for (const VoxelCell& cell : cells.cells) {
    if (cell.end - cell.begin >= kFewest || holds_around(cells, cell, kFewest)) continue;
    for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
      const std::uint32_t at = cells.order[i];
      const double away = distance_to(shell[at], centre);
      if (away >= from_m && away < kShell * from_m) alone.push_back(place[at]);
    }
  }
}

}  // namespace

bool Reach::holds(const Eigen::Vector3f& p) const {
  const Eigen::Array3d apart = (p.cast<double>() - centre).array().abs();
  return apart.x() <= far_m && apart.y() <= far_m && apart.z() <= far_m;  // no comparison with NaN
}

Reach measure_reach(std::span<const Eigen::Vector3f> points) {
  // Of a room 30 km: a scan reaches less far, and the grids of voxels a little further.
  constexpr double kFarExtents = 3e3;
  constexpr double kFarAtLeast_m = 100.0;
  constexpr double kNearExtents = 4.0;  // of a frame of a room some 12 m
  const Bulk bulk = measure_bulk(points);
  return {bulk.centre,
          std::max(kFarAtLeast_m, kFarExtents * bulk.extent_m),
          kNearExtents * bulk.extent_m};
}

std::size_t drop_far_alone(std::span<const Eigen::Vector3f> points,
                           const Reach& reach,
                           std::vector<std::uint32_t>& kept,
                           const RunContext& context) {
  constexpr std::size_t kFewestOfBulk = 100;  // in fewer points none is a bulk
  constexpr double kMostAlone = 0.005;
  constexpr double kLeastOfAll = 1e-6;  // of how far out the bulk lies: a spot has no extent
  const double all_m = std::max(1.0, reach.centre.cwiseAbs().maxCoeff());
  if (kept.size() < kFewestOfBulk || !(reach.near_m > kLeastOfAll * all_m)) return 0;
  std::vector<std::uint32_t> far;  // places in `kept`
  for (std::uint32_t k = 0; k < kept.size(); ++k) {
    if (distance_to(points[kept[k]], reach.centre) >= reach.near_m / kBeside) far.push_back(k);
  }
  // Shell by shell, each twice as far as the last, as surface is seen the more thinly the farther
  // it is.
  std::vector<std::uint32_t> alone;
  for (double from_m = reach.near_m; !far.empty(); from_m *= kShell) {
    find_alone(points, reach.centre, from_m, kept, far, alone, context);
    std::erase_if(far, [&](std::uint32_t k) {
      return distance_to(points[kept[k]], reach.centre) < kShell * from_m / kBeside;
    });
  }
  if (static_cast<double>(alone.size()) > kMostAlone * static_cast<double>(kept.size())) return 0;
  constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint32_t k : alone) kept[k] = kDropped;
  return alone.empty() ? 0 : std::erase(kept, kDropped);
}

}  // namespace landmarkdb
