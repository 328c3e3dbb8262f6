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

// The guard, one element a pixel of PCL's border extractor.
//
// PCL 1.13 turns the direction in which the surface changes into a cell of an angle histogram and
// does not check the angle: NaN becomes cell INT_MIN, a write far outside. Two inputs lead there.
// A border's plane seen exactly edge-on divides by its zero slope, and the direction is not finite.
// And a direction along the line of sight, projected into the image, may leave components of 1e-20,
// whose squares underflow; divided by their length they exceed 1, and the arc cosine is NaN. Both
// take surfaces as exact as only a simulated scan has. So pixels without a finite direction lose
// their score, and components below float rounding become zero.
void mend_surface_changes(std::span<float> scores, std::span<Eigen::Vector3f> directions);

}  // namespace landmarkdb
