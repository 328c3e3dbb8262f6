#pragma once

#include <span>

#include <Eigen/Core>

namespace landmarkdb {

// Where points lie as a whole: their mean, and the root mean square of their distances from it (the
// radius of gyration). Metres. Without what lies far beyond all others, which would be most of
// both: more than 20 times the median distance from the median. Zeros for no points.
struct Gyration {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};
Gyration measure_gyration(std::span<const Eigen::Vector3f> points);

}  // namespace landmarkdb
