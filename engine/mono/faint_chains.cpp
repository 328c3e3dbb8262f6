#include "engine/mono/faint_chains.hpp"

#include <vector>

#include "engine/mono/split_chain.hpp"

namespace landmarkdb {

void keep_straight_runs(EdgeChains& chains) {
  // Faint edges are some 0.4 px off; waves of light 40 px long and shorter bend more than that.
  constexpr double kStraight_px = 1.5;
  constexpr float kShortest_px = 12.0F;
  const EdgeChain chain = chains.chains.back();
  chains.chains.pop_back();
  const std::vector<EdgePoint> points(chains.points.begin() + chain.begin, chains.points.end());
  chains.points.resize(chain.begin);
  const std::vector<std::size_t> splits = split_chain(points, kStraight_px);
  bool goes_on = false;
  for (std::size_t i = 0; i + 1 < splits.size(); ++i) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(splits[i]);
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(splits[i + 1]);
    const bool straight = (last->uv - first->uv).norm() >= kShortest_px;
    if (straight) {
      if (!goes_on) {
        const auto at = static_cast<std::uint32_t>(chains.points.size());
        chains.chains.push_back({at, at, false});
        chains.points.push_back(*first);
      }
      chains.points.insert(chains.points.end(), first + 1, last + 1);
      chains.chains.back().end = static_cast<std::uint32_t>(chains.points.size());
    }
    goes_on = straight;
  }
}

}  // namespace landmarkdb
