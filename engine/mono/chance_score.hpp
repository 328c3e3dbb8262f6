#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/mono/image_view.hpp"
#include "engine/mono/pose_check.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

inline constexpr double kFinal_px = 3.5;  // of a 640 pixels wide image: the last round's tolerance
inline constexpr std::size_t kLeastHits = 5;

// log10 of the number of false alarms (Moisan and Stival 2004): how many poses as good as the
// candidate's chance alone would make among `options.log10_tests` hypotheses. `seen` are the
// model's points visible from there, `reach_px` is how far a match may lie from its feature. Counts
// the matched points, the links between them and the directions of the edges at them.
double log10_false_alarms(const MonoCandidate& candidate,
                          const SearchModel& model,
                          const ImageView& image,
                          std::span<const std::uint16_t> seen,
                          double reach_px,
                          const CheckOptions& options);

// log10 of P(at least `hits` of `trials`), each by chance `p`.
double log10_binomial_tail(std::size_t trials, std::size_t hits, double p);

// Where a point before the camera is seen, in pixels from the principal point, without distortion.
inline Eigen::Vector2d straight_px(const ImageView& image, const Eigen::Vector3d& X) {
  return image.focal_px() * X.head<2>() / X.z();
}

}  // namespace landmarkdb
