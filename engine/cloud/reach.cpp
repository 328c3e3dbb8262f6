#include "engine/cloud/reach.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace landmarkdb {
namespace {

// Middle of the values, and half the width of what holds the middle half of them.
struct Bulk {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double extent_m = 0.0;
};

double take_median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Bulk measure_bulk(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kLooked = 10'000;  // a median needs no more
  const std::size_t step = points.size() / kLooked + 1;
  Bulk bulk;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < points.size(); i += step) {
      if (points[i].allFinite()) values.push_back(points[i][axis]);
    }
    if (values.empty()) return bulk;
    bulk.centre[axis] = take_median(values);
    for (double& value : values) value = std::abs(value - bulk.centre[axis]);
    half[axis] = take_median(values);
  }
  bulk.extent_m = 2.0 * half.norm();
  return bulk;
}

}  // namespace

bool Reach::holds(const Eigen::Vector3f& p) const {
  const Eigen::Array3d apart = (p.cast<double>() - centre).array().abs();
  return apart.x() <= far_m && apart.y() <= far_m && apart.z() <= far_m;  // no comparison with NaN
}

Reach measure_reach(std::span<const Eigen::Vector3f> points) {
  // Of a room 30 km: a scan reaches less far, and the grids of voxels a little further.
  constexpr double kFarExtents = 3e3;
  constexpr double kFarAtLeast_m = 100.0;
  const Bulk bulk = measure_bulk(points);
  return {bulk.centre, std::max(kFarAtLeast_m, kFarExtents * bulk.extent_m)};
}

}  // namespace landmarkdb
