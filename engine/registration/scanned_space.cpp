#include "engine/registration/scanned_space.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace landmarkdb {

namespace {

// Points 5 cm apart leave few holes from 2 m on. At 3 degrees half as much of what wrong poses put
// in empty space is told.
constexpr double kStepRad = 1.5 * std::numbers::pi / 180.0;
constexpr std::size_t kMostImages = 64;     // those of most points
constexpr std::size_t kFewestPoints = 500;  // of an image

constexpr float kSlackCells = 3.0F;

// Whether the surface stands between the viewpoint and the point.
bool is_hidden(const SurfaceGrid& surface,
               const Eigen::Vector3f& viewpoint,
               const Eigen::Vector3f& point) {
  constexpr float kFirstCells = 6.0F;  // from the point on: the surface that it is of
  constexpr float kOnSurface = 0.5F;   // cells from the surface's plane
  const float cell_m = surface.cell_m();
  const Eigen::Vector3f way = viewpoint - point;
  const float length = way.norm();
  const Eigen::Vector3f step = way * (cell_m / std::max(length, cell_m));
  const Surfel* own = surface.near(point);
  const int last = static_cast<int>(length / cell_m) - 1;
  for (int k = static_cast<int>(kFirstCells); k < last; ++k) {
    const Eigen::Vector3f p = point + static_cast<float>(k) * step;
    const Surfel* met = surface.near(p);
    if (met == nullptr || (met->point - p).norm() > cell_m) continue;
    if (std::abs(met->normal.dot(p - met->point)) > kOnSurface * cell_m) continue;
    // A floor that the ray grazes is not left after a few steps.
    const bool grazed = own != nullptr && std::abs(own->normal.dot(p - own->point)) < 2.0F * cell_m;
    if (!grazed) return true;
  }
  return false;
}

// Whether the points can have been seen from the viewpoint. The edges of thinned surfaces hide 1 to
// 16 % of a scan from its own viewpoint; of scans merged, 30 to 80 % lie behind something.
bool saw_its_points(const SurfaceGrid& surface,
                    const Eigen::Vector3f& viewpoint,
                    std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kLooked = 300;
  constexpr double kMostHidden = 0.22;
  const std::size_t step = points.size() / kLooked + 1;
  std::size_t looked = 0;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < points.size(); i += step) {
    ++looked;
    hidden += is_hidden(surface, viewpoint, points[i]) ? 1U : 0U;
  }
  return static_cast<double>(hidden) <= kMostHidden * static_cast<double>(looked);
}

}  // namespace

ScannedSpace::ScannedSpace(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> viewpoints,
                           std::span<const std::uint16_t> viewpoint_index,
                           const SurfaceGrid& surface)
    : slack_m_(kSlackCells * surface.cell_m()) {
  const auto seen = points_by_viewpoint(points, viewpoints.size(), viewpoint_index);
  std::vector<std::size_t> order(viewpoints.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return seen[a].size() > seen[b].size();
  });
  for (const std::size_t k : order) {
    if (seen[k].size() < kFewestPoints || images_.size() == kMostImages) break;
    if (!saw_its_points(surface, viewpoints[k], seen[k])) continue;
    images_.emplace_back(seen[k], viewpoints[k], kStepRad);
  }
}

bool ScannedSpace::is_empty_at(const Eigen::Vector3f& p) const {
  return std::any_of(images_.begin(), images_.end(), [&](const RangeImage& image) {
    return image.looked_through(p, slack_m_);
  });
}

std::size_t ScannedSpace::memory_bytes() const {
  std::size_t bytes = 0;
  for (const RangeImage& image : images_) bytes += image.memory_bytes();
  return bytes;
}

}  // namespace landmarkdb
