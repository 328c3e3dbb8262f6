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
    worst = away > most ? i : worst;
    most = away > most ? away : most;
  }
  return {worst, most};
}

}  // namespace

std::span<const std::size_t> ChainSplitter::split(std::span<const EdgePoint> points,
                                                  double tolerance_px) {
  splits_.assign(1, 0);
  open_.assign(1, points.size() - 1);
  while (!open_.empty()) {
    const auto [worst, away] = farthest(points, splits_.back(), open_.back());
    if (away > tolerance_px) {
      open_.push_back(worst);
    } else {
      splits_.push_back(open_.back());
      open_.pop_back();
    }
  }
  return splits_;
}

}  // namespace landmarkdb
