#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb::testing {

// `rows` histograms of kShotLength bins, sparse and in clusters as descriptors of real surfaces
// are: each is one of `clusters` centres with noise. Unit length.
inline std::vector<float> random_descriptors(std::size_t rows,
                                             std::size_t clusters,
                                             std::uint64_t seed) {
  Random random(seed);
  std::vector<float> centres(clusters * kShotLength);
  for (float& v : centres) v = random.uniform() < 0.4 ? static_cast<float>(random.uniform()) : 0.0F;
  std::vector<float> values;
  values.reserve(rows * kShotLength);
  for (std::size_t i = 0; i < rows; ++i) {
    const float* centre = centres.data() + random.below(clusters) * kShotLength;
    double squared = 0.0;
    for (std::size_t j = 0; j < kShotLength; ++j) {
      const double v = static_cast<double>(centre[j]) * random.uniform(0.6, 1.4);
      squared += v * v;
      values.push_back(static_cast<float>(v));
    }
    const auto scale = static_cast<float>(1.0 / std::sqrt(squared));
    for (std::size_t j = 0; j < kShotLength; ++j) values[i * kShotLength + j] *= scale;
  }
  return values;
}

}  // namespace landmarkdb::testing
