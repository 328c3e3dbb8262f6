#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// How far from the bulk of a scan's points others can lie: 3,000 times the bulk's own extent, at
// least 100 m, on each axis; and further from it than four times the extent not alone.
struct Reach {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double far_m = 0.0;
  double near_m = 0.0;

  bool holds(const Eigen::Vector3f& p) const;  // not what is not finite; lone or not
};

// By the middle half of some 10,000 of the points, evenly chosen, which a few far ones do not move.
Reach measure_reach(std::span<const Eigen::Vector3f> points);

// Drops from `kept` (indices of points, which all are within reach) those further off than
// `near_m` that have fewer than three others around, within a twentieth of the way there; returns
// how many. A beam through a raindrop, or zeros of some other frame: a single one a kilometre off
// is most of a room's extent. Where more than one in two hundred are so the cloud is sparse, and
// all stay, as in one of fewer than a hundred points. Throws what `context.check` does.
std::size_t drop_far_alone(std::span<const Eigen::Vector3f> points,
                           const Reach& reach,
                           std::vector<std::uint32_t>& kept,
                           const RunContext& context);

}  // namespace landmarkdb
