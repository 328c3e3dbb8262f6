#include "engine/retrieval/place_outline.hpp"

#include "engine/features/structure_keypoints.hpp"

namespace landmarkdb {

namespace {

constexpr double kCells = 4.0;  // 20 cm in a room described at 5 cm
constexpr int kReachCells = 1;

}  // namespace

PlaceOutline thinned_outline(const PreparedCloud& cloud, double cell_m) {
  PlaceOutline outline;
  for (const std::uint32_t i : uniform_keypoints(cloud, cell_m).index) {
    outline.points.push_back(cloud.points[i]);
    outline.normals.push_back(cloud.normals[i]);
  }
  return outline;
}

PlaceOutline make_place_outline(const PreparedCloud& cloud) {
  return thinned_outline(cloud, kCells * cloud.resolution_m);
}

SurfaceGrid outline_grid(const PlaceOutline& outline, double voxel_m) {
  return SurfaceGrid(outline.points, outline.normals, kCells * voxel_m, kReachCells);
}

}  // namespace landmarkdb
