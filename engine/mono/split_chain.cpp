#include "engine/mono/split_chain.hpp"

#include <cmath>
#include <utility>

namespace landmarkdb {
namespace {

// The point of (first, last) that is farthest from the straight line between the two.
std::pair<std::size_t, double> farthest(std::span<const EdgePoint> points,
                                        std::size_t first,
                                        std::size_t last) {
  const Eigen::Vector2f from = points[first].uv;
  const Eigen::Vector2f along = points[last].uv - from;
  const float length = along.norm();
  std::size_t worst = first;
  float most = 0.0F;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Eigen::Vector2f w = points[i].uv - from;
    const float away =
        length > 1e-3F ? std::abs(along.x() * w.y() - along.y() * w.x()) / length : w.norm();
    if (away > most) {
      most = away;
      worst = i;
    }
  }
  return {worst, most};
}

}  // namespace

std::vector<std::size_t> split_chain(std::span<const EdgePoint> points, double tolerance_px) {
  std::vector<std::size_t> splits{0};
  std::vector<std::size_t> open{points.size() - 1};  // right ends still to be reached
  while (!open.empty()) {
    const auto [worst, away] = farthest(points, splits.back(), open.back());
    if (away > tolerance_px) {
      open.push_back(worst);
    } else {
      splits.push_back(open.back());
      open.pop_back();
    }
  }
  return splits;
}

}  // namespace landmarkdb
