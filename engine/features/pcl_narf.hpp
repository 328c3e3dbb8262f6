#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// Interest points of one range image, taken from zero: PCL's NARF keypoint detector, guarded.
//
// `points` in the sensor's frame, finite; those nearer than 1 mm or farther than 1,000 km are left
// out. The image is a sphere's equirectangular map whose poles lie where the fewest points are; its
// pixels are `angular_resolution_rad` wide (clamped to 0.3 .. 5 degrees). Thread-safe.
std::vector<Eigen::Vector3f> narf_interest_points(std::span<const Eigen::Vector3f> points,
                                                  double angular_resolution_rad,
                                                  double support_m);

}  // namespace landmarkdb
