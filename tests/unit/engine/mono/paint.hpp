#pragma once

#include <cstdint>
#include <functional>

#include "engine/types/grey_image.hpp"

namespace landmarkdb::testing {

// An image of a scene given as its grey value at each place (pixel centres at whole numbers),
// averaged over every pixel by 8 x 8 samples.
inline GreyImage paint(std::uint32_t width,
                       std::uint32_t height,
                       const std::function<double(double, double)>& grey) {
  constexpr int kSamples = 8;
  GreyImage image{width, height, {}};
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      double sum = 0.0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        sum += grey(u - 0.5 + (i % kSamples + 0.5) / kSamples,
                    v - 0.5 + (i / kSamples + 0.5) / kSamples);
      }
      image.pixels.push_back(static_cast<std::uint8_t>(sum / (kSamples * kSamples) + 0.5));
    }
  }
  return image;
}

}  // namespace landmarkdb::testing
