#pragma once

#include <cstddef>
#include <optional>

#include "engine/base/run_context.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/grey_image.hpp"

namespace landmarkdb {

struct FeatureSearchOptions {
  bool smooth = true;          // by a Gaussian of sigma 1 px
  double low_contrast = 0.0;   // grey levels; 0: from the image's noise
  double high_contrast = 0.0;  // 0: 4 times the low one
  std::size_t min_chain_points = 12;
  double split_px = 1.5;  // chains are split where they bend by more
  double min_segment_px = 8.0;
  double vertex_reach_px = 5.0;  // lines this close to meeting do meet
  // Lines are fitted where this camera's lens does not bend them; results are in the image's
  // pixels all the same.
  std::optional<Camera> camera{};
  // The longest or strongest are kept beyond; the same ones every time.
  std::size_t max_points = 2'000;
  std::size_t max_segments = 4'000;
  std::size_t max_ellipses = 1'000;
  std::size_t max_edges = 2'000'000;
};

// Finds what may be a model's features: edges, straight and elliptic pieces of them, and the points
// these make.
//
// `points`, strongest first: vertices (corners, T and X junctions, with the directions of their
// edges), centres of ellipses, centroids of closed contours that are no ellipse, inflexions of
// smooth arcs, each with what its position is good for. `links`: vertices joined by a segment. All
// in pixels of the image as it is. Where the camera's lens bends, ellipses and centres are those of
// the straightened image carried back: the centre of a circle's projection before distortion.
//
// Throws Error{kInvalidArgument} for an image whose pixels do not fit its size, or a camera of
// another size; Error{kCancelled} and kDeadlineExceeded when stopped. O(pixels). Thread-safe.
ImageFeatures find_image_features(const GreyImage& image,
                                  const FeatureSearchOptions& options,
                                  const RunContext& run);

}  // namespace landmarkdb
