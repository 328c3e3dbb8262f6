#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/grey_image.hpp"

namespace landmarkdb {

// Contrast is in grey levels: of a sharp step that would have the same gradient.
struct EdgeOptions {
  bool smooth = true;          // by a binomial of sigma 1 px
  double low_contrast = 0.0;   // points below are none; 0: from the image's noise
  double high_contrast = 0.0;  // a chain without it has to be straight; 0: 4 times the low one
  std::size_t max_points = 2'000'000;  // the weakest are left out beyond
};

// The edge points of an image by rows, left to right.
struct EdgeMap {
  std::vector<EdgePoint> points{};
  std::vector<std::int32_t> columns{};  // of the pixel each was found in
  std::vector<float> contrasts{};
  std::vector<std::uint32_t> row_starts{};  // height + 1
  double low_contrast = 0.0;
  double high_contrast = 0.0;
};

// The standard deviation of the image's noise, in grey levels: the median of a Laplacian's
// difference, which edges hardly change (after Immerkaer 1996).
double image_noise(const GreyImage& image);

// The places where the grey gradient (Sobel) is largest along itself, to a fraction of a pixel
// by a parabola along the nearer axis (after Devernay 1995), unlinked.
//
// Works row by row, so memory is taken for the points only. O(pixels). Throws what `run` throws.
EdgeMap find_edge_points(const GreyImage& image, const EdgeOptions& options, const RunContext& run);

}  // namespace landmarkdb
