#include "engine/mono/faint_chains.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace landmarkdb {

void keep_straight_runs(EdgeChains& chains, ChainSplitter& splitter) {
  // Faint edges are some 0.4 px off; waves of light 40 px long and shorter bend more than that.
  constexpr double kStraight_px = 1.5;
  constexpr float kShortest_px = 12.0F;
  const std::uint32_t begin = chains.chains.back().begin;
  chains.chains.pop_back();
  const std::span<EdgePoint> points = std::span(chains.points).subspan(begin);
  const std::span<const std::size_t> splits = splitter.split(points, kStraight_px);
  std::size_t kept = 0;  // moved to the front, before what is yet to be looked at
  bool goes_on = false;
  for (std::size_t i = 0; i + 1 < splits.size(); ++i) {
    const std::size_t first = splits[i], last = splits[i + 1];
    const bool straight = (points[last].uv - points[first].uv).norm() >= kShortest_px;
    if (straight) {
      const auto at = begin + static_cast<std::uint32_t>(kept);
      if (!goes_on) chains.chains.push_back({at, at, false});
      const std::size_t from = goes_on ? first + 1 : first;
      std::copy(&points[from], &points[last] + 1, &points[kept]);
      kept += last + 1 - from;
      chains.chains.back().end = begin + static_cast<std::uint32_t>(kept);
    }
    goes_on = straight;
  }
  chains.points.resize(begin + kept);
}

}  // namespace landmarkdb
