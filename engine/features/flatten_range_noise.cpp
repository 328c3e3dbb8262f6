#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/parallel.hpp"
#include "engine/cloud/gathered_points.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "engine/features/range_noise.hpp"
#include "engine/features/sensor_ray.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kCellsAtATime = 64;  // between two looks at the stop request

// What is laid flat, and how.
struct Flattening {
  const PreparedCloud& cloud;
  const RangeNoise& noise;
  float harmless_m;  // noise that normals and descriptors bear
  float least_radius_m;

  // Wide enough to hold the whole slab of scattered points.
  float radius_m(float sigma_m) const {
    constexpr float kPerNoise = 5.0F;
    constexpr float kMostWider = 3.0F;
    return std::clamp(kPerNoise * sigma_m, least_radius_m, kMostWider * least_radius_m);
  }
};

// The widest plane about a point that scatters no more than its noise makes it; one of infinite
// scatter where there is none.
ScatterPlane noisy_plane(const Flattening& task,
                         const GatheredPoints& around,
                         const Eigen::Vector3f& point,
                         const SensorRay& ray,
                         float sigma_m) {
  constexpr float kStillPlane = 2.0F;  // times the noise along the normal
  constexpr float kNarrower = 0.7F;
  for (float radius = task.radius_m(sigma_m); radius >= task.least_radius_m; radius *= kNarrower) {
    const ScatterPlane plane = around.fit_plane(point, radius);
    if (plane.sigma_m <= kStillPlane * sigma_m * ray.steepness(plane.normal)) return plane;
  }
  return {};
}

// Lays the points of one cell flat; `gathered` is memory to work with.
void flatten_cell(const Flattening& task,
                  const CellGrid& grid,
                  const CellGrid::Run& cell,
                  GatheredPoints& gathered,
                  PointCloud& flat) {
  const PreparedCloud& cloud = task.cloud;
  float most_sigma_m = 0.0F;
  for (std::uint32_t place = cell.begin; place < cell.end; ++place) {
    const SensorRay ray = ray_to(cloud, grid.order()[place]);
    most_sigma_m = std::max(most_sigma_m, task.noise.at(ray.range_m));
  }
  if (most_sigma_m <= task.harmless_m) return;
  const CellGrid::Ball ball = grid.ball_around(cell);
  gathered.gather(grid, ball.centre, task.radius_m(most_sigma_m) + ball.radius_m);
  for (std::uint32_t place = cell.begin; place < cell.end; ++place) {
    const std::size_t i = grid.order()[place];
    const SensorRay ray = ray_to(cloud, i);
    const float sigma_m = task.noise.at(ray.range_m);
    if (sigma_m <= task.harmless_m) continue;
    const ScatterPlane plane = noisy_plane(task, gathered, cloud.points[i], ray, sigma_m);
    if (!std::isfinite(plane.sigma_m)) continue;
    flat.points[i] -= plane.normal * plane.normal.dot(cloud.points[i] - plane.mean);
    flat.normals[i] = plane.normal.dot(cloud.normals[i]) < 0.0F ? -plane.normal : plane.normal;
  }
}

}  // namespace

void flatten_range_noise(PreparedCloud& cloud,
                         const RangeNoise& noise,
                         double radius_m,
                         const RunContext& context) {
  constexpr double kHarmless = 0.2;  // of the resolution
  const Flattening task{cloud,
                        noise,
                        static_cast<float>(kHarmless * cloud.resolution_m),
                        static_cast<float>(radius_m)};
  if (noise.sigma_m.empty() || noise.sigma_m.back() <= task.harmless_m) return;

  const CellGrid grid(cloud.points, radius_m);
  PointCloud flat;
  flat.points = cloud.points;
  flat.normals = cloud.normals;
  flat.origin = cloud.origin;
  flat.viewpoints = cloud.viewpoints;
  flat.viewpoint_index = cloud.viewpoint_index;
  const auto flatten = [&](std::size_t begin, std::size_t end) {
    context.check("preprocess");
    GatheredPoints gathered;
    for (std::size_t i = begin; i < end; ++i) {
      flatten_cell(task, grid, grid.cell(i), gathered, flat);
    }
  };
  parallel_runs(grid.cells(), kCellsAtATime, context.threads, flatten);
  PointCloud thinned = thin(flat, cloud.resolution_m, context);
  cloud.points = std::move(thinned.points);
  cloud.normals = std::move(thinned.normals);
  cloud.viewpoint_index = std::move(thinned.viewpoint_index);
}

}  // namespace landmarkdb
