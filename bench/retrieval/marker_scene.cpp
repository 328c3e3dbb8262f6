#include "bench/retrieval/marker_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {

namespace {

constexpr double kNearest_m = 2.0, kFarthest_m = 4.0;
constexpr double kMostTilt_rad = 35.0 * std::numbers::pi / 180.0;
constexpr double kMiddle = 0.7;  // of the image's width and height
constexpr double kMargin = 1.3;  // of the marker's size: the white around it must be free as well
constexpr double kBlur_px = 0.8;
constexpr double kNoise = 2.0;
constexpr int kSamples = 4;  // along each edge of a pixel, on the marker

using Vector3d = Eigen::Vector3d;

Vector3d ray_through(const Camera& camera, double u, double v) {
  return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0};
}

bool in_sight(const datasets::Place& place,
              const Eigen::Isometry3d& T_scene_camera,
              const Eigen::Isometry3d& T_camera_marker,
              double size_m) {
  const double half = 0.5 * kMargin * size_m;
  for (const auto& [x, y] :
       {std::array{0.0, 0.0}, {-half, -half}, {half, -half}, {half, half}, {-half, half}}) {
    const Vector3d p = T_scene_camera * (T_camera_marker * Vector3d(x, y, 0.0));
    if (place.caster->blocked(T_scene_camera.translation().cast<float>(), p.cast<float>())) {
      return false;
    }
  }
  return true;
}

// Grey of the building where the ray ends: each object its own shade, lit from above the camera.
double shade(const datasets::Place& place, const Vector3d& origin, const Vector3d& direction) {
  constexpr float kFar_m = 100.0F;
  constexpr double kSky = 30.0;
  const Vector3d unit = direction.normalized();
  const auto hit = place.caster->first_hit(origin.cast<float>(), unit.cast<float>(), kFar_m);
  if (!hit) return kSky;
  const std::uint32_t object = place.mesh.object[hit->triangle];
  const double albedo = 0.35 + 0.5 * Random(object + 1).uniform();
  const Vector3d light = (place.up - 0.5 * unit).normalized();
  const double lit = std::abs(hit->normal.cast<double>().dot(light));
  return 255.0 * albedo * (0.35 + 0.65 * lit);
}

// Grey of the marker where the ray (camera frame) meets it; nothing beside it.
std::optional<double> marker_grey(const MarkerPattern& pattern,
                                  double cell_m,
                                  const Eigen::Isometry3d& T_marker_camera,
                                  const Vector3d& ray) {
  const Vector3d eye = T_marker_camera.translation();
  const Vector3d direction = T_marker_camera.linear() * ray;
  if (!(direction.z() > 0.0) || !(eye.z() < 0.0)) return std::nullopt;
  const Vector3d p = eye - eye.z() / direction.z() * direction;
  const int column = static_cast<int>(std::floor(p.x() / cell_m + 0.5 * pattern.cells));
  const int row = static_cast<int>(std::floor(p.y() / cell_m + 0.5 * pattern.cells));
  if (column < 0 || row < 0 || column >= pattern.cells || row >= pattern.cells) return std::nullopt;
  constexpr double kBlack = 25.0, kPaper = 0.85;  // ink is not black, paper not white
  const auto value = pattern.values[static_cast<std::size_t>(row * pattern.cells + column)];
  return kBlack + kPaper * (255.0 - kBlack) * value / 255.0;
}

std::vector<double> blurred(const std::vector<double>& image, int width, int height) {
  constexpr int kReach = 3;
  std::array<double, 2 * kReach + 1> kernel{};
  double sum = 0.0;
  for (int i = -kReach; i <= kReach; ++i) {
    sum += kernel[static_cast<std::size_t>(i + kReach)] =
        std::exp(-0.5 * i * i / (kBlur_px * kBlur_px));
  }
  const auto pass = [&](const std::vector<double>& in, int step_x, int step_y) {
    std::vector<double> out(in.size());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double value = 0.0;
        for (int i = -kReach; i <= kReach; ++i) {
          const int u = std::clamp(x + i * step_x, 0, width - 1);
          const int v = std::clamp(y + i * step_y, 0, height - 1);
          value += kernel[static_cast<std::size_t>(i + kReach)] / sum *
                   in[static_cast<std::size_t>(v * width + u)];
        }
        out[static_cast<std::size_t>(y * width + x)] = value;
      }
    }
    return out;
  };
  return pass(pass(image, 1, 0), 0, 1);
}

}  // namespace

std::optional<Eigen::Isometry3d> place_marker(const datasets::Place& place,
                                              const Eigen::Isometry3d& T_scene_camera,
                                              const Camera& camera,
                                              double size_m,
                                              std::uint64_t seed) {
  constexpr int kTries = 200;
  Random random(seed);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double depth = random.uniform(kNearest_m, kFarthest_m);
    const double u = (0.5 + kMiddle * random.uniform(-0.5, 0.5)) * camera.width;
    const double v = (0.5 + kMiddle * random.uniform(-0.5, 0.5)) * camera.height;
    const double around = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3d axis(std::cos(around), std::sin(around), 0.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = depth * ray_through(camera, u, v);
    T.linear() = rotation_between(Vector3d::UnitZ(), T.translation()) *
                 rotation_from_vector(random.uniform(0.0, kMostTilt_rad) * axis);
    if (in_sight(place, T_scene_camera, T, size_m)) return T;
  }
  return std::nullopt;
}

GreyImage render_grey(const datasets::Place& place,
                      const Eigen::Isometry3d& T_scene_camera,
                      const Camera& camera,
                      const MarkerPattern& pattern,
                      double size_m,
                      const Eigen::Isometry3d& T_camera_marker,
                      std::uint64_t seed) {
  GreyImage image{.width = static_cast<int>(camera.width),
                  .height = static_cast<int>(camera.height),
                  .pixels = {}};
  const double cell_m = size_m / pattern.border_cells;
  const Eigen::Isometry3d T_marker_camera = T_camera_marker.inverse();
  std::vector<double> grey;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double behind = shade(
          place, T_scene_camera.translation(), T_scene_camera.linear() * ray_through(camera, x, y));
      double sum = 0.0;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const double u = x - 0.5 + (s % kSamples + 0.5) / kSamples;
        const double v = y - 0.5 + (s / kSamples + 0.5) / kSamples;
        const auto on = marker_grey(pattern, cell_m, T_marker_camera, ray_through(camera, u, v));
        sum += on.value_or(behind);
      }
      grey.push_back(sum / (kSamples * kSamples));
    }
  }
  Random random(seed);
  for (const double value : blurred(grey, image.width, image.height)) {
    const double noisy = std::clamp(value + kNoise * random.normal(), 0.0, 255.0);
    image.pixels.push_back(static_cast<std::uint8_t>(std::lround(noisy)));
  }
  return image;
}

}  // namespace landmarkdb::bench
