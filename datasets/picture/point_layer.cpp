#include "datasets/picture/point_layer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace landmarkdb::datasets {
namespace {

constexpr int kFine = 2;  // samples a pixel on each axis
constexpr float kNothing = -std::numeric_limits<float>::infinity();

constexpr std::array<std::array<int, 2>, 8> kAround = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

struct DepthGrid {
  int width, height;
  std::vector<float> nearness;  // kNothing where no point lies

  float at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return kNothing;
    return nearness[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  }
};

DepthGrid splat(int width, int height, std::span<const ViewPoint> points, float radius_px) {
  DepthGrid grid{kFine * width, kFine * height, {}};
  grid.nearness.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                       kNothing);
  const float radius = std::max(0.5F, radius_px * kFine);
  const int reach = static_cast<int>(radius);
  for (const ViewPoint& point : points) {
    const Eigen::Vector2f p = static_cast<float>(kFine) * point.px;
    if (!(p.x() > -10.0F && p.y() > -10.0F && p.x() < static_cast<float>(grid.width) + 10.0F &&
          p.y() < static_cast<float>(grid.height) + 10.0F)) {
      continue;
    }
    const int cx = static_cast<int>(std::floor(p.x()));
    const int cy = static_cast<int>(std::floor(p.y()));
    for (int y = std::max(0, cy - reach); y <= std::min(grid.height - 1, cy + reach); ++y) {
      for (int x = std::max(0, cx - reach); x <= std::min(grid.width - 1, cx + reach); ++x) {
        const auto dx = static_cast<float>(x - cx);
        const auto dy = static_cast<float>(y - cy);
        if (dx * dx + dy * dy > radius * radius) continue;
        float& cell =
            grid.nearness[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) +
                          static_cast<std::size_t>(x)];
        cell = std::max(cell, point.nearness_m);
      }
    }
  }
  return grid;
}

// Closes the gaps between the points of a surface: an empty sample takes the furthest of what lies
// around it when something does in at least five of eight directions.
DepthGrid close_gaps(const DepthGrid& grid) {
  constexpr int kReach = 8 * kFine;
  constexpr std::size_t kEnough = 5;
  DepthGrid closed = grid;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (grid.at(x, y) != kNothing) continue;
      std::array<float, 8> found{};
      std::size_t count = 0;
      for (const auto& [dx, dy] : kAround) {
        for (int reach = 1; reach <= kReach; ++reach) {
          const float there = grid.at(x + reach * dx, y + reach * dy);
          if (there == kNothing) continue;
          found[count++] = there;
          break;
        }
      }
      if (count < kEnough) continue;
      closed.nearness[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) +
                      static_cast<std::size_t>(x)] =
          *std::min_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }
  return closed;
}

// 1 in the open, towards 0 where the surroundings rise above the sample.
float light(const DepthGrid& grid, int x, int y, float strength) {
  constexpr float kNoise_m = 0.04F;   // steps below this are the sensor's
  constexpr float kDeepest_m = 0.6F;  // a step above this shades no more
  const float here = grid.at(x, y);
  float rise = 0.0F;
  for (const int reach : {2, 5}) {
    for (const auto& [dx, dy] : kAround) {
      const float there = grid.at(x + reach * dx, y + reach * dy);
      if (there == kNothing) continue;
      rise += std::clamp(there - here - kNoise_m, 0.0F, kDeepest_m);
    }
  }
  return std::exp(-strength * rise * 0.45F);
}

}  // namespace

void draw_points(Canvas& canvas,
                 int x0,
                 int y0,
                 int width,
                 int height,
                 std::span<const ViewPoint> points,
                 const PointStyle& style) {
  if (width <= 0 || height <= 0) return;
  DepthGrid grid = splat(width, height, points, style.radius_px);
  if (style.close_gaps) grid = close_gaps(grid);
  const float span = std::max(style.near_m - style.far_m, 1e-6F);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Colour sum = Colour::Zero();
      int covered = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const int fx = kFine * x + k % kFine;
        const int fy = kFine * y + k / kFine;
        const float nearness = grid.at(fx, fy);
        if (nearness == kNothing) continue;
        const float share = std::clamp((nearness - style.far_m) / span, 0.0F, 1.0F);
        sum += light(grid, fx, fy, style.shading) * (style.far + share * (style.near - style.far));
        ++covered;
      }
      if (covered == 0) continue;
      const float alpha = style.alpha * static_cast<float>(covered) / (kFine * kFine);
      blend(canvas, x0 + x, y0 + y, sum / static_cast<float>(covered), alpha);
    }
  }
}

}  // namespace landmarkdb::datasets
