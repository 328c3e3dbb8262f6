#include "engine/cloud/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "engine/cloud/voxel_cells.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kFewestPoints = 4;
constexpr std::size_t kLooked = 50'000;  // points the extent is taken from
constexpr std::size_t kSamples = 400;    // pieces of surface the spacing is taken from
// Above, distances come from the cells around a sample even where these are too small.
constexpr std::size_t kIndexWhole = 200'000;
constexpr double kCellsAcross = 64.0;   // a piece of surface is a cell of this part of the extent
constexpr std::size_t kNeighbour = 16;  // see surface_spacing

constexpr double kCutOff = 0.01;  // of the points at each end of each axis

// From the lowest value to the highest, without those at either end.
double middle_range(std::vector<float> values) {
  const auto cut = static_cast<std::ptrdiff_t>(kCutOff * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + cut, values.end());
  const double low = values[static_cast<std::size_t>(cut)];
  std::nth_element(values.begin(), values.end() - 1 - cut, values.end());
  return static_cast<double>(values[values.size() - 1 - static_cast<std::size_t>(cut)]) - low;
}

struct Weighed {
  float value;
  std::uint32_t weight;
};

// The same of values that stand for as many as their weights say.
double middle_range(std::vector<Weighed> values) {
  std::sort(values.begin(), values.end(), [](const Weighed& a, const Weighed& b) {
    return std::tie(a.value, a.weight) < std::tie(b.value, b.weight);
  });
  std::uint64_t sum = 0;
  for (const Weighed& one : values) sum += one.weight;
  const auto cut = static_cast<std::uint64_t>(kCutOff * static_cast<double>(sum));
  const auto past_cut = [&](auto begin) {
    for (std::uint64_t passed = begin->weight; passed <= cut;) passed += (++begin)->weight;
    return static_cast<double>(begin->value);
  };
  return past_cut(values.rbegin()) - past_cut(values.begin());
}

// The distance to the k-th neighbour as the edge of the square that one point of an evenly sampled
// surface takes: k points lie in a circle of area pi d^2. The 16th neighbour, not the first: along
// a lidar ring the first is centimetres away where the next ring is a metre away.
double surface_spacing(double distance_m, std::size_t k) {
  return distance_m * std::sqrt(std::numbers::pi / static_cast<double>(k));
}

// A little less than the squared distance from `p` to what a cell can hold.
float squared_distance_to(const VoxelCell& cell, double cell_m, const Eigen::Vector3f& p) {
  constexpr double kSlack = 1e-4;  // of a cell, for points on its faces
  const Eigen::Vector3d low = cell_m * Eigen::Vector3d(static_cast<double>(cell.x),
                                                       static_cast<double>(cell.y),
                                                       static_cast<double>(cell.z));
  const Eigen::Array3d before = low.array() - p.cast<double>().array();
  const Eigen::Array3d beyond = before.max(-before - cell_m) - kSlack * cell_m;
  return static_cast<float>(beyond.max(0.0).matrix().squaredNorm());
}

// The squared distance from point `i` of a cell to its k-th neighbour in that cell and the 26
// around it, each counted by its weight; infinite where there are fewer. What is further off than k
// points of its own cell is not looked into. `squared` is memory to work with.
float kth_around(const PointCloud& cloud,
                 const VoxelCells& grid,
                 double cell_m,
                 const VoxelCell& own,
                 std::uint32_t i,
                 std::size_t k,
                 std::vector<float>& squared) {
  const std::vector<Eigen::Vector3f>& points = cloud.points;
  const auto weight = [&](std::uint32_t which) -> std::size_t {
    return cloud.weights.empty() ? 1 : std::min<std::size_t>(cloud.weights[which], k + 1);
  };
  squared.assign(weight(i) - 1, 0.0F);
  const auto add = [&](const VoxelCell& cell) {
    for (std::uint32_t at = cell.begin; at < cell.end; ++at) {
      const std::uint32_t other = grid.order[at];
      if (other == i) continue;
      const float distance = (points[other] - points[i]).squaredNorm();
      for (std::size_t n = weight(other); n > 0; --n) squared.push_back(distance);
    }
  };
  const auto kth = [&] {
    if (squared.size() < k) return std::numeric_limits<float>::infinity();
    const auto at = squared.begin() + static_cast<std::ptrdiff_t>(k - 1);
    std::nth_element(squared.begin(), at, squared.end());
    squared.resize(k);
    return squared.back();
  };
  add(own);
  const float reach = kth();
  any_around(grid, own, [&](const VoxelCell& cell) {
    const bool is_own = cell.begin == own.begin;
    if (!is_own && squared_distance_to(cell, cell_m, points[i]) <= reach) add(cell);
    return false;
  });
  return kth();
}

// One point of each of some cells, all over the surface.
std::vector<const VoxelCell*> sample_cells(const VoxelCells& grid) {
  const std::size_t step = (grid.cells.size() + kSamples - 1) / kSamples;
  std::vector<const VoxelCell*> cells;
  for (std::size_t c = 0; c < grid.cells.size(); c += step) cells.push_back(&grid.cells[c]);
  return cells;
}

// The point at half of the cell's weight.
std::uint32_t middle_point(const PointCloud& cloud, const VoxelCells& grid, const VoxelCell& cell) {
  if (cloud.weights.empty()) return grid.order[cell.begin + (cell.end - cell.begin) / 2];
  std::uint64_t sum = 0;
  for (std::uint32_t k = cell.begin; k < cell.end; ++k) sum += cloud.weights[grid.order[k]];
  std::uint32_t k = cell.begin;
  for (std::uint64_t passed = cloud.weights[grid.order[k]]; passed <= sum / 2;) {
    passed += cloud.weights[grid.order[++k]];
  }
  return grid.order[k];
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The median distance of the samples to their k-th neighbour, exact below `cell_m`: what is nearer
// lies in the cells around. Of those that have fewer there the cell's size is all that is known.
double near_distance(const PointCloud& cloud,
                     const VoxelCells& grid,
                     double cell_m,
                     std::size_t k,
                     const RunContext& context) {
  const std::vector<const VoxelCell*> cells = sample_cells(grid);
  std::vector<double> distances(cells.size(), cell_m);
  parallel_chunks(cells.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<float> squared;
    for (std::size_t i = begin; i < end; ++i) {
      const float found = kth_around(
          cloud, grid, cell_m, *cells[i], middle_point(cloud, grid, *cells[i]), k, squared);
      if (std::isfinite(found)) distances[i] = std::sqrt(static_cast<double>(found));
    }
  });
  return median(std::move(distances));
}

double far_distance(const PointCloud& cloud, const VoxelCells& grid, std::size_t k) {
  const SpatialIndex index(cloud.points);
  std::vector<double> distances;
  std::vector<Neighbour> neighbours;
  for (const VoxelCell* cell : sample_cells(grid)) {
    index.nearest(cloud.points[middle_point(cloud, grid, *cell)], k + 1, neighbours);
    distances.push_back(std::sqrt(static_cast<double>(neighbours.back().squared_distance_m2)));
  }
  return median(std::move(distances));
}

double sample_spacing(const PointCloud& cloud,
                      const VoxelCells& grid,
                      double cell_m,
                      const RunContext& context) {
  const std::size_t k = std::min(kNeighbour, cloud.size() - 1);
  double distance_m = near_distance(cloud, grid, cell_m, k, context);
  if (distance_m >= cell_m && cloud.size() <= kIndexWhole) {
    distance_m = far_distance(cloud, grid, k);
  }
  return surface_spacing(distance_m, k);
}

}  // namespace

double measure_extent(const PointCloud& cloud, const RunContext& context) {
  if (cloud.empty()) return 0.0;
  const std::size_t step = cloud.size() / kLooked + 1;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  parallel_each(3, context.threads, [&](std::size_t which) {
    const auto axis = static_cast<Eigen::Index>(which);
    std::vector<float> values;
    std::vector<Weighed> weighed;
    for (std::size_t i = 0; i < cloud.size(); i += step) {
      const float value = cloud.points[i][axis];
      if (cloud.weights.empty()) values.push_back(value);
      if (!cloud.weights.empty()) weighed.push_back({value, cloud.weights[i]});
    }
    size[axis] =
        weighed.empty() ? middle_range(std::move(values)) : middle_range(std::move(weighed));
  });
  return size.norm();
}

CloudScale measure_scale(const PointCloud& cloud, const RunContext& context) {
  if (cloud.size() < kFewestPoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "the cloud has " + std::to_string(cloud.size()) + " usable points, want at least " +
                    std::to_string(kFewestPoints));
  }
  CloudScale scale;
  scale.extent_m = measure_extent(cloud, context);
  if (!(scale.extent_m > 0.0) || !std::isfinite(scale.extent_m)) return scale;
  const double cell_m = scale.extent_m / kCellsAcross;
  scale.spacing_m =
      sample_spacing(cloud, group_by_voxel(cloud.points, cell_m, context), cell_m, context);
  return scale;
}

bool units_look_wrong(const CloudScale& scale, EntryKind kind) {
  // A place is a room to a district, an object a screw to a lorry; metres read as millimetres, or
  // the other way round, fall outside by an order of magnitude or more.
  constexpr double kPlaceLow_m = 0.5, kPlaceHigh_m = 1000.0;
  constexpr double kObjectLow_m = 0.01, kObjectHigh_m = 30.0;
  const bool place = kind == EntryKind::kPlace;
  return scale.extent_m < (place ? kPlaceLow_m : kObjectLow_m) ||
         scale.extent_m > (place ? kPlaceHigh_m : kObjectHigh_m);
}

}  // namespace landmarkdb
