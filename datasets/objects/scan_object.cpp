#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/objects/object_model.hpp"
#include "datasets/ray_caster.hpp"
#include "datasets/ray_noise.hpp"
#include "engine/base/parallel.hpp"

namespace landmarkdb::datasets {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Unit vectors from the object towards where it is scanned from; its front looks to -y.
std::vector<Eigen::Vector3d> directions_of(ObjectViews views) {
  std::vector<Eigen::Vector3d> directions;
  const auto ring = [&](double elevation, double first, double last, double step) {
    for (double azimuth = first; azimuth < last; azimuth += step) {
      const double e = elevation * kDegree;
      const double a = (azimuth - 90.0) * kDegree;
      directions.emplace_back(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    }
  };
  if (views == ObjectViews::kFront) {
    ring(5.0, -65.0, 66.0, 32.5);
    ring(40.0, -40.0, 41.0, 40.0);
    return directions;
  }
  ring(10.0, 0.0, 359.0, 45.0);
  ring(45.0, 0.0, 359.0, 60.0);
  ring(85.0, 0.0, 179.0, 180.0);
  if (views == ObjectViews::kAround) ring(-45.0, 0.0, 359.0, 60.0);
  return directions;
}

}  // namespace

PointCloud scan_object(const ObjectModel& model,
                       const ObjectScanOptions& options,
                       const RunContext& context) {
  constexpr double kAway = 3.0;  // extents
  const RayCaster caster(model.mesh);
  const double spacing_m = options.spacing_m > 0.0 ? options.spacing_m : 0.01 * model.extent_m;
  const auto side = static_cast<std::size_t>(std::ceil(1.1 * model.extent_m / spacing_m));
  PointCloud cloud;
  std::uint64_t view = 0;
  for (const Eigen::Vector3d& direction : directions_of(options.views)) {
    context.check("scan");
    const Eigen::Vector3d eye = model.centre + kAway * model.extent_m * direction;
    const Eigen::Vector3d right = direction.unitOrthogonal();
    const Eigen::Vector3d down = direction.cross(right);
    std::vector<Eigen::Vector3f> seen(side * side, Eigen::Vector3f::Constant(NAN));
    parallel_chunks(seen.size(), context.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto offset = [&](std::size_t k) {
          return (static_cast<double>(k) - 0.5 * static_cast<double>(side)) * spacing_m;
        };
        const Eigen::Vector3d aim =
            model.centre + offset(i % side) * right + offset(i / side) * down;
        const Eigen::Vector3f ray = (aim - eye).normalized().cast<float>();
        const auto hit = caster.first_hit(
            eye.cast<float>(), ray, static_cast<float>(2.0 * kAway * model.extent_m));
        constexpr float kGrazing = 0.2F;  // cosine: flatter surface is rarely measured
        if (!hit || !hit->front_face || -hit->normal.dot(ray) < kGrazing) continue;
        Random random = ray_random(options.seed + 7919 * view, i);
        const auto noise = static_cast<float>(options.noise_m * random.normal());
        seen[i] = eye.cast<float>() + (hit->distance_m + noise) * ray;
      }
    });
    for (const Eigen::Vector3f& p : seen) {
      if (!p.allFinite()) continue;
      cloud.points.push_back(p);
      if (options.keep_viewpoints) {
        cloud.viewpoint_index.push_back(static_cast<std::uint16_t>(view));
      }
    }
    if (options.keep_viewpoints) cloud.viewpoints.emplace_back(eye.cast<float>());
    ++view;
  }
  return cloud;
}

}  // namespace landmarkdb::datasets
