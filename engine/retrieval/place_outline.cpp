#include "engine/retrieval/place_outline.hpp"

#include "engine/features/structure_keypoints.hpp"

namespace landmarkdb {

namespace {

constexpr double kCells = 4.0;  // 20 cm in a room described at 5 cm
constexpr int kReachCells = 1;

}  // namespace

ThinSurface thinned_surface(const PreparedCloud& cloud, double cell_m) {
  ThinSurface surface;
  for (const std::uint32_t i : uniform_keypoints(cloud, cell_m).index) {
    surface.points.push_back(cloud.points[i]);
    surface.normals.push_back(cloud.normals[i]);
  }
  return surface;
}

PlaceOutline make_place_outline(const SceneRecord& record) {
  return {thinned_surface(record.prepared, kCells * record.prepared.resolution_m),
          record.descriptors.keypoints,
          pack_rotations(record.descriptors.frames)};
}

SurfaceGrid outline_grid(const ThinSurface& surface, double voxel_m) {
  return SurfaceGrid(surface.points, surface.normals, kCells * voxel_m, kReachCells);
}

}  // namespace landmarkdb
