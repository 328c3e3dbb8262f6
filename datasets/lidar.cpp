#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/depth_camera.hpp"
#include "datasets/ray_noise.hpp"
#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr float kNoRange = 0.0F;
constexpr float kEdge_m = 0.3F;  // the wide beam of a small laser straddles edges of this size

Eigen::Vector3f ray(const LidarOptions& options, std::size_t i) {
  const auto columns = static_cast<std::size_t>(options.columns);
  const double azimuth =
      2.0 * std::numbers::pi * static_cast<double>(i % columns) / options.columns;
  const double share =
      options.lines == 1 ? 0.5 : static_cast<double>(i / columns) / (options.lines - 1);
  const double elevation = std::lerp(options.lowest_rad, options.highest_rad, share);
  return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                         std::cos(elevation) * std::sin(azimuth),
                         std::sin(elevation))
      .cast<float>();
}

}  // namespace

PointCloud render_lidar(const Place& place,
                        const Eigen::Isometry3d& T_scene_lidar,
                        const LidarOptions& options,
                        const RunContext& context) {
  if (options.lines < 1 || options.lines > 1024 || options.columns < 4 || options.columns > 16384) {
    throw Error(ErrorCode::kInvalidArgument,
                "lidar: " + std::to_string(options.lines) + " lines x " +
                    std::to_string(options.columns) +
                    " columns, want 1 to 1024 lines and 4 to 16384 columns");
  }
  context.check("render");
  const std::size_t rays = static_cast<std::size_t>(options.lines * options.columns);
  const Eigen::Matrix3f R = T_scene_lidar.linear().cast<float>();
  const Eigen::Vector3f origin = T_scene_lidar.translation().cast<float>();
  std::vector<float> ranges(rays, kNoRange);
  parallel_chunks(rays, context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto hit = place.caster->first_hit(
          origin, R * ray(options, i), static_cast<float>(options.max_range_m));
      if (hit && hit->returns_light && hit->distance_m >= options.min_range_m) {
        ranges[i] = hit->distance_m;
      }
    }
  });
  PointCloud cloud;
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  for (std::size_t i = 0; i < rays; ++i) {
    if (ranges[i] == kNoRange) continue;
    Random random = ray_random(options.seed, i);
    double range = ranges[i];
    const double beside = ranges[(i + 1) % rays];
    if (beside > 0.0 && std::abs(beside - range) > kEdge_m &&
        random.uniform() < options.mixed_pixels) {
      range = random.uniform(std::min(range, beside), std::max(range, beside));
    }
    range += options.noise_m * random.normal();
    if (range > 0.0) cloud.points.emplace_back(static_cast<float>(range) * ray(options, i));
  }
  return cloud;
}

}  // namespace landmarkdb::datasets
