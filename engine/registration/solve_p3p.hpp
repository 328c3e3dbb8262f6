#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// The poses from which three points are seen in three directions (the perspective-three-point
// problem, by Grunert's quartic as Haralick et al. 1994 give it): up to four, T_bearing_point.
//
// `bearings` of unit length, from the eye; `points` in any frame. None when the points or the
// bearings are collinear.
std::vector<Eigen::Isometry3d> solve_p3p(std::span<const Eigen::Vector3d, 3> bearings,
                                         std::span<const Eigen::Vector3d, 3> points);

}  // namespace landmarkdb
