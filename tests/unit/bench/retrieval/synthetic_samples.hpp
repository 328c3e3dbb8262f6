#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "bench/retrieval/calibration_samples.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::bench {

// Normal features whose rows are right with the chance that `weights` (the constant first) say, the
// rows dealt out to the places in turn.
inline Samples synthetic_samples(const Eigen::VectorXd& weights,
                                 Eigen::Index rows,
                                 std::size_t places,
                                 std::uint64_t seed) {
  Random random(seed);
  Samples samples;
  samples.names.emplace_back("constant");
  for (Eigen::Index i = 1; i < weights.size(); ++i) {
    samples.names.push_back("feature_" + std::to_string(i));
  }
  for (std::size_t i = 0; i < places; ++i) samples.place_names.push_back("f " + std::to_string(i));
  samples.features = Eigen::MatrixXd::Ones(rows, weights.size());
  samples.right = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index k = 1; k < weights.size(); ++k) samples.features(i, k) = random.normal();
    const double z = samples.features.row(i).dot(weights);
    samples.right[i] = random.uniform() < 1.0 / (1.0 + std::exp(-z)) ? 1.0 : 0.0;
    samples.places.push_back(static_cast<std::size_t>(i) % places);
  }
  return samples;
}

}  // namespace landmarkdb::bench
