#include "tests/support/make_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "engine/base/random.hpp"

namespace landmarkdb::testing {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kWallGap_m = 0.25;  // stations and cameras keep away from walls

struct Span {
  double enter = -kNever;
  double leave = kNever;
};

// Where a ray is inside the axis-aligned box |p| <= half (slab method).
Span inside_box(const Eigen::Vector3d& from,
                const Eigen::Vector3d& direction,
                const Eigen::Vector3d& half) {
  Span span;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(from[axis]) > half[axis]) return {kNever, -kNever};
      continue;
    }
    const double a = (-half[axis] - from[axis]) / direction[axis];
    const double b = (half[axis] - from[axis]) / direction[axis];
    span.enter = std::max(span.enter, std::min(a, b));
    span.leave = std::min(span.leave, std::max(a, b));
  }
  return span;
}

Span inside_ball(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double radius) {
  const double along = -from.dot(direction);
  const double gap2 = radius * radius - (from + along * direction).squaredNorm();
  if (gap2 < 0.0) return {kNever, -kNever};
  return {along - std::sqrt(gap2), along + std::sqrt(gap2)};
}

double hit_m(const Solid& solid, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d local = from - solid.center_m;
  Span span;
  if (solid.ball) {
    span = inside_ball(local, direction, solid.half_m.x());
  } else {
    const Eigen::AngleAxisd turn(-solid.yaw_rad, Eigen::Vector3d::UnitZ());
    span = inside_box(turn * local, turn * direction, solid.half_m);
  }
  return span.enter <= span.leave && span.enter > 0.0 ? span.enter : kNever;
}

// Whether no solid comes nearer to `p` than the gap.
bool is_free(const SyntheticScene& scene, const Eigen::Vector3d& p, double gap_m) {
  return std::ranges::none_of(scene.solids, [&](const Solid& solid) {
    const Eigen::Vector3d local = p - solid.center_m;
    if (solid.ball) return local.norm() < solid.half_m.x() + gap_m;
    const Eigen::AngleAxisd turn(-solid.yaw_rad, Eigen::Vector3d::UnitZ());
    return ((turn * local).array().abs() < solid.half_m.array() + gap_m).all();
  });
}

Eigen::Vector3d random_place(const SyntheticScene& scene, Random& random, double z_m) {
  return {random.uniform(kWallGap_m, scene.room_m.x() - kWallGap_m),
          random.uniform(kWallGap_m, scene.room_m.y() - kWallGap_m),
          z_m};
}

// Furniture stands on the floor, hangs on a wall, or stands on other furniture.
Solid random_solid(const SyntheticScene& scene, Random& random) {
  Solid solid;
  solid.ball = random.uniform() < 0.2;
  solid.yaw_rad = random.uniform(0.0, std::numbers::pi);
  solid.half_m = {random.uniform(0.1, 0.55), random.uniform(0.1, 0.4), random.uniform(0.1, 0.6)};
  if (solid.ball) solid.half_m.setConstant(random.uniform(0.15, 0.45));
  solid.center_m = random_place(scene, random, solid.half_m.z());
  const double kind = random.uniform();
  if (kind < 0.3) {  // on a wall
    const int axis = static_cast<int>(random.below(2));
    solid.center_m[axis] = random.uniform() < 0.5 ? 0.0 : scene.room_m[axis];
    solid.center_m.z() = random.uniform(0.5, scene.room_m.z() - 0.4);
  } else if (kind < 0.55 && !scene.solids.empty()) {  // on top of something
    const Solid& below = scene.solids[random.below(scene.solids.size())];
    const double top = below.center_m.z() + below.half_m.z();
    solid.half_m *= 0.5;
    solid.center_m = below.center_m;
    solid.center_m.z() = top + solid.half_m.z() * 0.9;
  }
  return solid;
}

// Direction `i` of `n` spread evenly over the sphere (golden spiral).
Eigen::Vector3d sphere_direction(std::uint32_t i, std::uint32_t n) {
  const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double z = 1.0 - 2.0 * (i + 0.5) / n;
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(golden_rad * i), r * std::sin(golden_rad * i), z};
}

PointCloud scan_from(const SyntheticScene& scene,
                     const Eigen::Vector3d& station,
                     const SceneOptions& options,
                     Random& random) {
  PointCloud cloud;
  cloud.viewpoints = {station.cast<float>()};
  cloud.points.reserve(options.rays);
  for (std::uint32_t i = 0; i < options.rays; ++i) {
    const Eigen::Vector3d direction = sphere_direction(i, options.rays);
    const double range = first_hit_m(scene, station, direction) + random.normal() * options.noise_m;
    cloud.points.emplace_back((station + range * direction).cast<float>());
  }
  return cloud;
}

void append(PointCloud& all, const PointCloud& scan) {
  const auto index = static_cast<std::uint16_t>(all.viewpoints.size());
  all.points.insert(all.points.end(), scan.points.begin(), scan.points.end());
  all.viewpoint_index.resize(all.points.size(), index);
  all.viewpoints.push_back(scan.viewpoints.front());
}

}  // namespace

double first_hit_m(const SyntheticScene& scene,
                   const Eigen::Vector3d& from,
                   const Eigen::Vector3d& direction) {
  const Eigen::Vector3d half = scene.room_m / 2.0;
  double nearest = inside_box(from - half, direction, half).leave;
  for (const Solid& solid : scene.solids)
    nearest = std::min(nearest, hit_m(solid, from, direction));
  return nearest;
}

SyntheticScene make_scene(const SceneOptions& options) {
  Random random(options.seed * 7919 + 17);
  SyntheticScene scene;
  scene.room_m = {random.uniform(4.5, 7.0), random.uniform(4.0, 6.0), random.uniform(2.5, 3.2)};
  if (options.room_m.norm() > 0.0) scene.room_m = options.room_m;
  for (std::uint32_t i = 0; i < options.furniture; ++i) {
    scene.solids.push_back(random_solid(scene, random));
  }
  for (std::uint32_t i = 0; i < options.stations; ++i) {
    Eigen::Vector3d station = random_place(scene, random, 1.6);
    while (!is_free(scene, station, 0.05)) {
      station = random_place(scene, random, random.uniform(1.2, 2.2));
    }
    scene.scans.push_back(scan_from(scene, station, options, random));
    append(scene.cloud, scene.scans.back());
  }
  return scene;
}

PointCloud view_of(const SyntheticScene& scene,
                   const Eigen::Isometry3d& T_scene_sensor,
                   const ViewOptions& options) {
  const Camera& camera = options.camera;
  Random random(options.seed);
  PointCloud cloud;
  cloud.width = camera.width;
  cloud.height = camera.height;
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  cloud.points.reserve(std::size_t{camera.width} * camera.height);
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray =
          Eigen::Vector3d((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0)
              .normalized();
      const double range =
          first_hit_m(scene, T_scene_sensor.translation(), T_scene_sensor.linear() * ray);
      const double measured = range + random.normal() * options.noise_m;
      if (range > options.max_range_m) {
        cloud.points.emplace_back(
            Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
      } else {
        cloud.points.emplace_back((measured * ray).cast<float>());
      }
    }
  }
  return cloud;
}

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().col(0) = x;
  T.linear().col(1) = z.cross(x);
  T.linear().col(2) = z;
  T.translation() = eye;
  return T;
}

Eigen::Isometry3d make_view_pose(const SyntheticScene& scene, std::uint64_t seed) {
  constexpr double kClear_m = 0.8;  // nothing closer than this fills the lens
  Random random(seed * 104'729 + 3);
  for (;;) {
    const Eigen::Vector3d eye = random_place(scene, random, random.uniform(1.2, 1.8));
    const Solid& aim = scene.solids[random.below(scene.solids.size())];
    const Eigen::Vector3d flat(aim.center_m.x() - eye.x(), aim.center_m.y() - eye.y(), 0.0);
    const bool far_enough = flat.norm() > 0.6 * scene.room_m.head<2>().minCoeff();
    if (!far_enough || !is_free(scene, eye, 0.1)) continue;
    const Eigen::Isometry3d T = look_at(eye, aim.center_m);
    if (first_hit_m(scene, eye, T.linear().col(2)) > kClear_m) return T;
  }
}

}  // namespace landmarkdb::testing
