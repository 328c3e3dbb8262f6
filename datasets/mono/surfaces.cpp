#include "datasets/mono/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kNearest_m = 1e-3;
constexpr double kMiddle = 145.0, kHalfRange = 85.0;  // grey levels: faces from 60 to 230

double shade(Random& random, const RenderOptions& options) {
  return kMiddle + options.contrast * random.uniform(-kHalfRange, kHalfRange);
}

// `corners` in the camera's frame, metres.
void add_polygon(std::span<const Eigen::Vector3d> corners,
                 double lift,
                 double grey,
                 std::vector<Surface>& surfaces) {
  Surface surface;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  surface.low.setConstant(std::numeric_limits<double>::max());
  surface.high = -surface.low;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d& p = corners[i];
    if (p.z() < kNearest_m) return;
    normal += p.cross(corners[(i + 1) % corners.size()]);
    middle += p / static_cast<double>(corners.size());
    surface.outline.emplace_back(p.head<2>() / p.z());
    surface.low = surface.low.cwiseMin(surface.outline.back());
    surface.high = surface.high.cwiseMax(surface.outline.back());
  }
  const double distance = normal.dot(middle);
  if (std::abs(distance) < 1e-15) return;  // seen edge-on
  surface.inverse_depth = normal / distance;
  surface.lift = lift;
  surface.grey = grey;
  surfaces.push_back(std::move(surface));
}

bool inside(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  bool in = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Eigen::Vector2d &a = outline[i], &b = outline[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      in = !in;
    }
  }
  return in;
}

}  // namespace

void add_model(const SeenModel& seen,
               const RenderOptions& options,
               std::uint64_t seed,
               std::vector<Surface>& surfaces) {
  constexpr int kRimCorners = 96;
  Random random(seed);
  std::vector<Eigen::Vector3d> corners;
  for (const std::vector<std::uint32_t>& face : seen.model->faces) {
    corners.clear();
    for (const std::uint32_t i : face) {
      corners.push_back(seen.T_camera_object * seen.model->points[i].xyz);
    }
    add_polygon(corners, 0.0, shade(random, options), surfaces);
  }
  for (const ModelCircle& circle : seen.model->circles) {
    const Eigen::Vector3d u = circle.normal.unitOrthogonal(), v = circle.normal.cross(u);
    corners.clear();
    for (int i = 0; i < kRimCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kRimCorners;
      const Eigen::Vector3d rim = circle.radius_m * (std::cos(angle) * u + std::sin(angle) * v);
      corners.push_back(seen.T_camera_object * (circle.center + rim));
    }
    constexpr double kLift = 1e-6;  // 1/m: upon its face, behind whatever stands before that
    constexpr double kDark = 30.0;
    add_polygon(corners, kLift, kMiddle + options.contrast * (kDark - kMiddle), surfaces);
  }
}

void add_clutter(const Camera& camera,
                 const RenderOptions& options,
                 std::vector<Surface>& surfaces) {
  constexpr double kFar_m = 1e4;
  Random random(options.seed ^ 0xc1u);
  const double aspect = camera.fx / std::abs(camera.fy);
  for (int n = 0; n < options.clutter; ++n) {
    const Eigen::Vector2d center(
        (random.uniform(0.0, camera.width) - camera.cx) / camera.fx,
        (random.uniform(0.0, camera.height) - camera.cy) / std::abs(camera.fy));
    const double size = random.uniform(8.0, 0.15 * camera.width) / camera.fx;
    const std::uint64_t corners = random.below(4) == 0 ? 64 : 3 + random.below(4);
    const double flat = random.uniform(0.4, 1.0), turn = random.uniform(0.0, 6.28);
    std::vector<Eigen::Vector3d> outline;
    for (std::uint64_t i = 0; i < corners; ++i) {
      const double angle =
          2.0 * std::numbers::pi *
          (static_cast<double>(i) + (corners < 10 ? random.uniform(-0.3, 0.3) : 0.0)) /
          static_cast<double>(corners);
      const Eigen::Vector2d p(size * std::cos(angle), size * flat * std::sin(angle));
      const Eigen::Vector2d at =
          center + Eigen::Vector2d(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                                   aspect * (std::sin(turn) * p.x() + std::cos(turn) * p.y()));
      outline.emplace_back(kFar_m * at.x(), kFar_m * at.y(), kFar_m);
    }
    constexpr double kLift = 1e-9;  // later ones lie upon earlier ones
    add_polygon(outline, kLift * (n + 1), shade(random, options), surfaces);
  }
}

int first_surface(std::span<const Surface> surfaces,
                  std::span<const int> among,
                  const Eigen::Vector2d& ray) {
  int first = -1;
  double nearest = 0.0;  // as 1 / z
  for (const int i : among) {
    const Surface& surface = surfaces[static_cast<std::size_t>(i)];
    if ((ray.array() < surface.low.array()).any() || (ray.array() > surface.high.array()).any()) {
      continue;
    }
    const double inverse = surface.inverse_depth.dot(ray.homogeneous()) + surface.lift;
    if (inverse <= nearest || !inside(surface.outline, ray)) continue;
    nearest = inverse;
    first = i;
  }
  return first;
}

}  // namespace landmarkdb::datasets
