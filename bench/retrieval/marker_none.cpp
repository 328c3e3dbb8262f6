#include "bench/retrieval/marker.hpp"

namespace landmarkdb::bench {

std::string marker_name() { return {}; }

std::optional<MarkerPattern> marker_pattern() { return std::nullopt; }

std::optional<Eigen::Isometry3d> find_marker(const GreyImage&, const Camera&, double) {
  return std::nullopt;
}

}  // namespace landmarkdb::bench
