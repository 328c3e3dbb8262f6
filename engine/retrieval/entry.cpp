#include "engine/retrieval/entry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.hpp"

namespace landmarkdb {

namespace {

constexpr int kReachCells = 2;      // 10 cm in a room described at 5 cm
constexpr double kWideCells = 3.0;  // 15 cm there
constexpr std::size_t kTestPoints = 512;
constexpr std::size_t kLayouts = 1;  // what is built has one frame of right angles as a rule

// Errors name the scene: there may be hundreds.
SurfaceGrid grid_of_scene(const SceneRecord& record, const RunContext& context) {
  try {
    return make_grid(record.prepared, context);
  } catch (const Error& error) {
    if (error.field() != "voxel") throw;
    throw Error(error.code(), "scene '" + record.name + "': " + error.what(), error.field());
  }
}

// Objects are small, and seen close by: all of their points count.
SightSurface sight_of(const SceneRecord& record, int threads) {
  const PreparedCloud& cloud = record.prepared;
  const std::span<const Eigen::Vector3f> normals =
      cloud.normals_from_viewpoint ? cloud.normals : std::span<const Eigen::Vector3f>{};
  const bool is_object = record.kind == EntryKind::kObject;
  return SightSurface(cloud.points, normals, is_object ? 0.0 : cloud.resolution_m, threads);
}

std::vector<PlaneLayout> planes_of(const SceneRecord& record) {
  const PreparedCloud& cloud = record.prepared;
  return lay_out_planes(cloud.points, cloud.normals, plane_bin_m(cloud.resolution_m), kLayouts);
}

}  // namespace

double plane_bin_m(double voxel_m) {
  constexpr double kVoxels = 2.0;  // 10 cm in a room described at 5 cm
  return kVoxels * voxel_m;
}

SurfaceGrid make_grid(const PreparedCloud& cloud, const RunContext& context) {
  return SurfaceGrid(cloud.points, cloud.normals, cloud.resolution_m, kReachCells, context);
}

GridSize grid_size(std::span<const Eigen::Vector3f> points,
                   double voxel_m,
                   const RunContext& context) {
  return SurfaceGrid::size_for(points, voxel_m, kReachCells, context);
}

SurfaceGrid make_wide_grid(const PreparedCloud& cloud, const RunContext& context) {
  const double cell_m = kWideCells * cloud.resolution_m;
  const ThinSurface thinned = thinned_surface(cloud, cell_m);
  return SurfaceGrid(thinned.points, thinned.normals, cell_m, kReachCells, context);
}

Entry make_outline(CatalogEntry stored, PlaceOutline outline) {
  const double cell_m = stored.record->prepared.resolution_m;
  if (!outline.keypoints.empty()) {
    auto known = std::make_shared<SceneRecord>(*stored.record);
    known->descriptors.keypoints = std::move(outline.keypoints);
    stored.record = std::move(known);
  }
  return {.stored = std::move(stored),
          .grid = SurfaceGrid({}, {}, cell_m, 0),
          .wide = outline_grid(outline.surface, cell_m),
          .wide_sight = {},
          .planes = {},
          .test = {},
          .scanned = {},
          .frames = std::move(outline.frames),
          .sight = {},
          .centre = Eigen::Vector3d::Zero(),
          .extent_m = 0.0};
}

std::vector<std::uint32_t> spread(std::size_t size, std::size_t count) {
  const std::size_t taken = std::min(size, count);
  std::vector<std::uint32_t> indices(taken);
  for (std::size_t i = 0; i < taken; ++i) {
    indices[i] = static_cast<std::uint32_t>(i * size / std::max<std::size_t>(taken, 1));
  }
  return indices;
}

Entry make_entry(CatalogEntry stored, const RunContext& context) {
  const std::shared_ptr<const SceneRecord> held = stored.record;
  const SceneRecord& record = *held;
  const PreparedCloud& cloud = record.prepared;
  const bool is_object = record.kind == EntryKind::kObject;
  constexpr std::uint64_t kSeed = 1;  // an entry's own sample: the same for every query
  Entry entry{
      .stored = std::move(stored),
      .grid = grid_of_scene(record, context),
      .wide = is_object ? SurfaceGrid({}, {}, 1.0, 0) : make_wide_grid(cloud),
      .wide_sight = {},
      .planes = is_object ? Lazy<std::vector<PlaneLayout>>()
                          : Lazy<std::vector<PlaneLayout>>([held] { return planes_of(*held); }),
      .test = is_object ? select_test_points(cloud.points, cloud.normals, {}, kTestPoints, kSeed)
                        : TestPoints{},
      .scanned = {},
      .frames =
          is_object ? std::vector<PackedRotation>{} : pack_rotations(record.descriptors.frames),
      .sight = Lazy<SightSurface, int>([held](int threads) { return sight_of(*held, threads); }),
      .centre = Eigen::Vector3d::Zero(),
      .extent_m = 0.0};
  if (!is_object) {
    entry.scanned = ScannedSpace(cloud.points, cloud.viewpoints, cloud.viewpoint_index, entry.grid);
  }
  std::vector<Eigen::Vector3f> wide_points;
  for (const Surfel& surfel : entry.wide.surfels()) wide_points.push_back(surfel.point);
  entry.wide_sight = SightSurface(wide_points);
  for (const Eigen::Vector3f& point : cloud.points) entry.centre += point.cast<double>();
  const auto points = static_cast<double>(std::max<std::size_t>(cloud.size(), 1));
  entry.centre /= points;
  double squares = 0.0;
  for (const Eigen::Vector3f& point : cloud.points) {
    squares += (point.cast<double>() - entry.centre).squaredNorm();
  }
  entry.extent_m = 2.0 * std::sqrt(squares / points);
  return entry;
}

}  // namespace landmarkdb
