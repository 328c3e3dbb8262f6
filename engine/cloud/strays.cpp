#include "engine/cloud/strays.hpp"

#include <cstdint>
#include <vector>

#include "engine/cloud/keep_points.hpp"
#include "engine/cloud/voxel_cells.hpp"

namespace landmarkdb {
namespace {

constexpr double kMostStrays = 0.02;  // of the points; scans of rooms have 0.2 to 0.5 %

// Whether a point of the cell, or of one around it, other than `i` is near.
bool has_company(const std::vector<Eigen::Vector3f>& points,
                 const VoxelCells& cells,
                 const VoxelCell& own,
                 std::uint32_t i,
                 float radius) {
  const auto near_in = [&](const VoxelCell& cell) {
    for (std::uint32_t k = cell.begin; k < cell.end; ++k) {
      const std::uint32_t other = cells.order[k];
      if (other != i && (points[other] - points[i]).squaredNorm() <= radius * radius) return true;
    }
    return false;
  };
  return near_in(own) || any_around(cells, own, near_in);
}

}  // namespace

std::size_t drop_strays(PointCloud& cloud, double radius_m, const RunContext& context) {
  const VoxelCells cells = group_by_voxel(cloud.points, radius_m, context);
  const auto radius = static_cast<float>(radius_m);
  std::vector<char> alone(cloud.size(), 0);
  for (const VoxelCell& cell : cells.cells) {
    for (std::uint32_t k = cell.begin; k < cell.end; ++k) {
      const std::uint32_t i = cells.order[k];
      alone[i] = has_company(cloud.points, cells, cell, i, radius) ? 0 : 1;
    }
  }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (alone[i] == 0) kept.push_back(i);
  }
  const std::size_t strays = cloud.size() - kept.size();
  if (static_cast<double>(strays) > kMostStrays * static_cast<double>(cloud.size())) return 0;
  keep_points(cloud, kept);
  return strays;
}

}  // namespace landmarkdb
