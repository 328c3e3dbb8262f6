#include "engine/cloud/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/base/parallel.hpp"
#include "engine/cloud/voxel_cells.hpp"

namespace landmarkdb {
namespace {

Eigen::Vector3f mean(const std::vector<Eigen::Vector3f>& values,
                     std::span<const std::uint32_t> which) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : which) sum += values[i].cast<double>();
  return (sum / static_cast<double>(which.size())).cast<float>();
}

// Opposite normals can cancel (a thin wall seen from both sides); then the first one stands.
Eigen::Vector3f mean_normal(const std::vector<Eigen::Vector3f>& normals,
                            std::span<const std::uint32_t> which) {
  constexpr float kCancelled = 0.1F;
  const Eigen::Vector3f sum = mean(normals, which);
  const float length = sum.norm();
  return length > kCancelled ? Eigen::Vector3f(sum / length) : normals[which[0]];
}

std::array<std::uint8_t, 3> mean_colour(const std::vector<std::array<std::uint8_t, 3>>& colours,
                                        std::span<const std::uint32_t> which) {
  std::array<std::uint64_t, 3> sum{};
  for (const std::uint32_t i : which) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += colours[i][c];
  }
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>((sum[c] + which.size() / 2) / which.size());
  }
  return colour;
}

}  // namespace

PointCloud thin(const PointCloud& cloud, double voxel_m, const RunContext& context) {
  const VoxelCells grid = group_by_voxel(cloud.points, voxel_m, context);
  const std::size_t cells = grid.cells.size();
  PointCloud thinned;
  thinned.origin = cloud.origin;
  thinned.viewpoints = cloud.viewpoints;
  thinned.points.resize(cells);
  thinned.normals.resize(cloud.normals.empty() ? 0 : cells);
  thinned.colours.resize(cloud.colours.empty() ? 0 : cells);
  thinned.viewpoint_index.resize(cloud.viewpoint_index.empty() ? 0 : cells);
  parallel_chunks(cells, context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const VoxelCell& cell = grid.cells[i];
      const auto which =
          std::span<const std::uint32_t>(grid.order).subspan(cell.begin, cell.end - cell.begin);
      thinned.points[i] = mean(cloud.points, which);
      if (!cloud.normals.empty()) thinned.normals[i] = mean_normal(cloud.normals, which);
      if (!cloud.colours.empty()) thinned.colours[i] = mean_colour(cloud.colours, which);
      if (!cloud.viewpoint_index.empty()) {
        thinned.viewpoint_index[i] = cloud.viewpoint_index[which[0]];
      }
    }
  });
  context.check("voxels");
  return thinned;
}

}  // namespace landmarkdb
