#include "engine/cloud/voxel_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/parallel.hpp"
#include "engine/cloud/voxel_cells.hpp"

namespace landmarkdb {
namespace {

using Colour = std::array<std::uint8_t, 3>;
using Which = std::span<const std::uint32_t>;

// How much each point counts; all the same where there are no weights.
class Weights {
 public:
  explicit Weights(const std::vector<std::uint32_t>& weights) : weights_(weights) {}
  std::uint64_t of(std::uint32_t i) const { return weights_.empty() ? 1 : weights_[i]; }
  std::uint64_t sum(Which which) const {
    if (weights_.empty()) return which.size();
    std::uint64_t sum = 0;
    for (const std::uint32_t i : which) sum += weights_[i];
    return sum;
  }

 private:
  const std::vector<std::uint32_t>& weights_;
};

Eigen::Vector3f mean(const std::vector<Eigen::Vector3f>& values,
                     Which which,
                     const Weights& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : which) {
    sum += static_cast<double>(weights.of(i)) * values[i].cast<double>();
  }
  return (sum / static_cast<double>(weights.sum(which))).cast<float>();
}

// Opposite normals can cancel (a thin wall seen from both sides); then the first one stands.
Eigen::Vector3f mean_normal(const std::vector<Eigen::Vector3f>& normals,
                            Which which,
                            const Weights& weights) {
  constexpr float kCancelled = 0.1F;
  const Eigen::Vector3f sum = mean(normals, which, weights);
  const float length = sum.norm();
  return length > kCancelled ? Eigen::Vector3f(sum / length) : normals[which[0]];
}

Colour mean_colour(const std::vector<Colour>& colours, Which which, const Weights& weights) {
  std::array<std::uint64_t, 3> sum{};
  for (const std::uint32_t i : which) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weights.of(i) * colours[i][c];
  }
  const std::uint64_t count = weights.sum(which);
  Colour colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
  }
  return colour;
}

std::uint32_t sum_of_weights(Which which, const Weights& weights) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::min(kMost, weights.sum(which)));
}

// The cells in the order of their first points.
std::vector<std::uint32_t> by_first_point(const VoxelRuns& runs, std::size_t points) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> cell_at(points, kNone);
  for (std::uint32_t c = 0; c < runs.cells(); ++c) cell_at[runs.points_of(c)[0]] = c;
  std::erase(cell_at, kNone);
  return cell_at;
}

// What cells have of what their points have: nothing where these have none.
class CellMeans {
 public:
  // Cells come as `cell_at` says; by their keys where it is empty.
  CellMeans(const VoxelRuns& runs,
            const std::vector<std::uint32_t>& cell_at,
            const std::vector<std::uint32_t>& weights,
            const RunContext& context)
      : runs_(runs), cell_at_(cell_at), weights_(weights), context_(context) {}

  std::vector<Eigen::Vector3f> points(const std::vector<Eigen::Vector3f>& points) const {
    return of(points, [&](Which which) { return mean(points, which, weights_); });
  }
  std::vector<Eigen::Vector3f> normals(const std::vector<Eigen::Vector3f>& normals) const {
    return of(normals, [&](Which which) { return mean_normal(normals, which, weights_); });
  }
  std::vector<Colour> colours(const std::vector<Colour>& colours) const {
    return of(colours, [&](Which which) { return mean_colour(colours, which, weights_); });
  }
  std::vector<std::uint16_t> firsts(const std::vector<std::uint16_t>& values) const {
    return of(values, [&](Which which) { return values[which[0]]; });
  }
  std::vector<std::uint32_t> weights() const {
    return of(runs_.order, [&](Which which) { return sum_of_weights(which, weights_); });
  }

 private:
  template <typename Value, typename OfCell>
  std::vector<Value> of(const std::vector<Value>& values, const OfCell& of_cell) const {
    constexpr std::size_t kStep = std::size_t{1} << 16U;  // cells between two looks whether to stop
    std::vector<Value> result(values.empty() ? 0 : runs_.cells());
    parallel_runs(result.size(), kStep, context_.threads, [&](std::size_t begin, std::size_t end) {
      if (context_.should_stop()) return;
      for (std::size_t k = begin; k < end; ++k) {
        result[k] = of_cell(runs_.points_of(cell_at_.empty() ? k : cell_at_[k]));
      }
    });
    context_.check("voxels");
    return result;
  }

  const VoxelRuns& runs_;
  const std::vector<std::uint32_t>& cell_at_;
  Weights weights_;
  const RunContext& context_;
};

}  // namespace

PointCloud thin(const PointCloud& cloud, double voxel_m, const RunContext& context) {
  const VoxelRuns runs = find_voxel_runs(cloud.points, voxel_m, context);
  const std::vector<std::uint32_t> by_key;
  const CellMeans means(runs, by_key, cloud.weights, context);
  PointCloud thinned;
  thinned.origin = cloud.origin;
  thinned.viewpoints = cloud.viewpoints;
  thinned.points = means.points(cloud.points);
  thinned.normals = means.normals(cloud.normals);
  thinned.colours = means.colours(cloud.colours);
  thinned.viewpoint_index = means.firsts(cloud.viewpoint_index);
  return thinned;
}

void condense(PointCloud& cloud, double cell_m, const RunContext& context) {
  const VoxelRuns runs = find_voxel_runs(cloud.points, cell_m, context);
  const std::vector<std::uint32_t> cell_at = by_first_point(runs, cloud.size());
  const CellMeans means(runs, cell_at, cloud.weights, context);
  cloud.points = means.points(cloud.points);
  cloud.normals = means.normals(cloud.normals);
  cloud.colours = means.colours(cloud.colours);
  cloud.viewpoint_index = means.firsts(cloud.viewpoint_index);
  cloud.weights = means.weights();  // last: the others count by the old ones
  cloud.width = 0;
  cloud.height = 0;
}

}  // namespace landmarkdb
