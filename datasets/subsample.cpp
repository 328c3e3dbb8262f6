#include "datasets/subsample.hpp"

#include <string>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {

std::vector<std::size_t> choose(std::size_t n, std::size_t wanted, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> chosen;
  chosen.reserve(wanted);
  for (std::size_t i = 0; i < n && chosen.size() < wanted; ++i) {
    const auto missing = static_cast<double>(wanted - chosen.size());
    if (static_cast<double>(n - i) * random.uniform() < missing) chosen.push_back(i);
  }
  return chosen;
}

PointCloud subsample(const PointCloud& cloud, std::size_t points, std::uint64_t seed) {
  std::vector<std::size_t> finite;
  finite.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.points[i].allFinite()) finite.push_back(i);
  }
  if (points > finite.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                "the cloud has " + std::to_string(finite.size()) + " points with depth, want " +
                    std::to_string(points) + " of them");
  }
  PointCloud out;
  out.origin = cloud.origin;
  out.viewpoints = cloud.viewpoints;
  for (const std::size_t k : choose(finite.size(), points == 0 ? finite.size() : points, seed)) {
    const std::size_t i = finite[k];
    out.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
    if (!cloud.colours.empty()) out.colours.push_back(cloud.colours[i]);
    if (!cloud.viewpoint_index.empty()) out.viewpoint_index.push_back(cloud.viewpoint_index[i]);
  }
  return out;
}

}  // namespace landmarkdb::datasets
