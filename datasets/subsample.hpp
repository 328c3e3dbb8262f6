#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb::datasets {

// `wanted` of the numbers 0..n-1, ascending, each equally likely (Knuth 3.4.2, algorithm S).
// `wanted` <= n.
std::vector<std::size_t> choose(std::size_t n, std::size_t wanted, std::uint64_t seed);

// Exactly `points` of the cloud's finite points, in their order, no longer organised; all of them
// for 0. Throws Error{kInvalidArgument} when there are fewer.
PointCloud subsample(const PointCloud& cloud, std::size_t points, std::uint64_t seed);

}  // namespace landmarkdb::datasets
