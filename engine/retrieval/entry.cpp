#include "engine/retrieval/entry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace landmarkdb {

namespace {

constexpr int kReachCells = 2;                 // 10 cm in a room described at 5 cm
constexpr std::size_t kSightPoints = 200'000;  // free space is judged on what of these is in view
constexpr std::size_t kTestPoints = 512;

}  // namespace

SurfaceGrid make_grid(const PreparedCloud& cloud) {
  return SurfaceGrid(cloud.points, cloud.normals, cloud.resolution_m, kReachCells);
}

std::vector<std::uint32_t> spread(std::size_t size, std::size_t count) {
  const std::size_t taken = std::min(size, count);
  std::vector<std::uint32_t> indices(taken);
  for (std::size_t i = 0; i < taken; ++i) {
    indices[i] = static_cast<std::uint32_t>(i * size / std::max<std::size_t>(taken, 1));
  }
  return indices;
}

Entry make_entry(CatalogEntry stored) {
  const PreparedCloud& cloud = stored.record->prepared;
  constexpr std::uint64_t kSeed = 1;  // an entry's own sample: the same for every query
  Entry entry{.stored = std::move(stored),
              .grid = make_grid(cloud),
              .test = select_test_points(cloud.points, cloud.normals, kTestPoints, kSeed),
              .sight_points = {},
              .centre = Eigen::Vector3d::Zero(),
              .extent_m = 0.0};
  for (const Eigen::Vector3f& point : cloud.points) entry.centre += point.cast<double>();
  const auto points = static_cast<double>(std::max<std::size_t>(cloud.size(), 1));
  entry.centre /= points;
  double squares = 0.0;
  for (const Eigen::Vector3f& point : cloud.points) {
    squares += (point.cast<double>() - entry.centre).squaredNorm();
  }
  entry.extent_m = 2.0 * std::sqrt(squares / points);
  for (const std::uint32_t i : spread(cloud.size(), kSightPoints)) {
    entry.sight_points.push_back(cloud.points[i]);
  }
  return entry;
}

}  // namespace landmarkdb
