#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// How far from the bulk of a scan's points others can lie: 3,000 times the bulk's own extent, at
// least 100 m, on each axis; and beyond four times the extent not alone.
struct Reach {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double far_m = 0.0;
  double near_m = 0.0;

  bool holds(const Eigen::Vector3f& p) const;          // not what is not finite
  bool holds_at_hand(const Eigen::Vector3f& p) const;  // where it may be alone
};

// By the middle half of some 10,000 of the points, evenly chosen, which a few far ones do not move.
Reach measure_reach(std::span<const Eigen::Vector3f> points);

// Drops from `kept` (indices of points, which all are within reach) those beyond what is at hand
// that have fewer than three others of these around, within a twentieth of the way there; returns
// how many: none where there are fewer than a hundred. A beam through a raindrop, or zeros of some
// other frame: a single one a kilometre off is most of a room's extent. Throws what `context.check`
// does.
std::size_t drop_far_alone(std::span<const Eigen::Vector3f> points,
                           const Reach& reach,
                           std::vector<std::uint32_t>& kept,
                           const RunContext& context);

}  // namespace landmarkdb
