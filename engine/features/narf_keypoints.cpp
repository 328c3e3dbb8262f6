#include "engine/features/narf_keypoints.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/features/pcl_narf.hpp"

namespace landmarkdb {
namespace {

// The points that were seen from each viewpoint, by index.
std::vector<std::vector<std::uint32_t>> groups(const PreparedCloud& cloud) {
  std::vector<std::vector<std::uint32_t>> result(std::max<std::size_t>(cloud.viewpoints.size(), 1));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t group = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
    if (group >= result.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "point " + std::to_string(i) + " belongs to viewpoint " + std::to_string(group) +
                      " of " + std::to_string(cloud.viewpoints.size()));
    }
    result[group].push_back(static_cast<std::uint32_t>(i));
  }
  return result;
}

double median_range_m(const std::vector<Eigen::Vector3f>& points) {
  std::vector<float> ranges;
  ranges.reserve(points.size());
  for (const Eigen::Vector3f& p : points) ranges.push_back(p.norm());
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  return static_cast<double>(*middle);
}

// The place of the point nearest to `p` within `radius_m`.
std::optional<std::uint32_t> nearest(const CellGrid& grid,
                                     const Eigen::Vector3f& p,
                                     double radius_m,
                                     std::vector<CellGrid::Found>& found) {
  grid.within(p, static_cast<float>(radius_m), found);
  const auto best = std::min_element(found.begin(), found.end(), [&](const auto& a, const auto& b) {
    return a.squared_distance_m2 != b.squared_distance_m2
               ? a.squared_distance_m2 < b.squared_distance_m2
               : grid.order()[a.place] < grid.order()[b.place];
  });
  if (best == found.end()) return std::nullopt;
  return best->place;
}

}  // namespace

Keypoints narf_keypoints(const PreparedCloud& cloud, double support_m, const RunContext& context) {
  if (cloud.viewpoint_index.size() != cloud.size() && !cloud.viewpoint_index.empty()) {
    throw Error(ErrorCode::kInvalidArgument,
                "cloud has " + std::to_string(cloud.viewpoint_index.size()) +
                    " viewpoint indices for " + std::to_string(cloud.size()) + " points");
  }
  Keypoints result;
  const std::vector<std::vector<std::uint32_t>> by_viewpoint = groups(cloud);
  for (std::size_t viewpoint = 0; viewpoint < by_viewpoint.size(); ++viewpoint) {
    const std::vector<std::uint32_t>& group = by_viewpoint[viewpoint];
    context.check("keypoints");
    if (group.empty()) continue;
    const Eigen::Vector3f origin =
        cloud.viewpoints.empty() ? Eigen::Vector3f::Zero() : cloud.viewpoints[viewpoint];
    std::vector<Eigen::Vector3f> points;
    for (const std::uint32_t index : group) points.push_back(cloud.points[index] - origin);

    // One pixel a voxel at the usual range: finer, and the image is more holes than surface.
    const double range_m = std::max(median_range_m(points), cloud.resolution_m);
    const double pixel_rad = cloud.resolution_m / range_m;
    const CellGrid grid(points, 2.0 * cloud.resolution_m);
    std::vector<CellGrid::Found> found;
    for (const Eigen::Vector3f& p : narf_interest_points(points, pixel_rad, support_m)) {
      // An interest point is where its pixel's centre meets the surface, a pixel from the point
      // that was seen there.
      const double reach_m = 2.0 * (cloud.resolution_m + pixel_rad * static_cast<double>(p.norm()));
      if (const auto place = nearest(grid, p, reach_m, found)) {
        result.index.push_back(group[grid.order()[*place]]);
      }
    }
  }
  std::sort(result.index.begin(), result.index.end());
  result.index.erase(std::unique(result.index.begin(), result.index.end()), result.index.end());
  return result;
}

}  // namespace landmarkdb
