#include "bench/retrieval/peer.hpp"

#include <algorithm>

namespace landmarkdb::bench {

std::vector<Station> stations_of(const PointCloud& cloud) {
  std::vector<Station> stations(std::max<std::size_t>(cloud.viewpoints.size(), 1));
  for (std::size_t i = 0; i < cloud.viewpoints.size(); ++i) {
    stations[i].viewpoint = cloud.viewpoints[i];
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const std::size_t station = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
    stations[station].points.push_back(cloud.points[i]);
  }
  return stations;
}

}  // namespace landmarkdb::bench
