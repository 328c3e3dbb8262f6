#pragma once

#include <span>

#include <Eigen/Core>

namespace landmarkdb {

// Where points lie as a whole: their mean, and the root mean square of their distances from it.
// Metres. Without what lies far beyond all others, which would be most of both: where a point is
// more than 12 times as far as that root, only those within 20 times the median distance from the
// median count. Zeros for no points.
struct Spread {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};
Spread measure_spread(std::span<const Eigen::Vector3f> points);

}  // namespace landmarkdb
