#pragma once

#include <span>

#include <Eigen/Core>

namespace landmarkdb {

// How far from the bulk of a scan's points others can lie: 3,000 times the bulk's own extent, at
// least 100 m, on each axis.
struct Reach {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double far_m = 0.0;

  bool holds(const Eigen::Vector3f& p) const;  // not what is not finite
};

// By the middle half of some 10,000 of the points, evenly chosen, which a few far ones do not move.
Reach measure_reach(std::span<const Eigen::Vector3f> points);

}  // namespace landmarkdb
