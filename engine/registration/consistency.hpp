#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/types/correspondence.hpp"

namespace landmarkdb {

struct ConsistencyOptions {
  double tolerance_m = 0.1;       // two pairs agree when their distances differ by less
  double min_separation_m = 0.2;  // closer pairs agree by being close, and do not count
  std::size_t max_pairs =
      1500;  // the best by descriptor distance are looked at: cost is the square of it
};

// The largest set found of correspondences that all keep their mutual distances, as one rigid
// motion does: a clique of the compatibility graph, grown greedily from each of the best connected
// pairs (after Yang, Shi, Carlone 2020). Returned in the order given; empty when no three agree.
std::vector<Correspondence> filter_consistency(std::span<const Correspondence> correspondences,
                                               std::span<const Eigen::Vector3f> target,
                                               std::span<const Eigen::Vector3f> source,
                                               const ConsistencyOptions& options);

}  // namespace landmarkdb
