#pragma once

#include <cstdint>
#include <vector>

#include "engine/mono/edge_points.hpp"

namespace landmarkdb {

// A run of edge points one after the other, brighter on the left as the screen shows it.
struct EdgeChain {
  std::uint32_t begin = 0, end = 0;  // into the points
  bool closed = false;
};

struct EdgeChains {
  std::vector<EdgePoint> points{};  // chain after chain
  std::vector<EdgeChain> chains{};
};

// Links each edge point with the nearest one ahead of it and behind it whose direction turns by
// less than 60 degrees, and keeps the chains of at least `min_points`: whole where one point has
// high contrast, else the parts that run straight, which may be shorter (keep_straight_runs). At a
// junction the straightest nearest link wins, and the others end there.
EdgeChains link_edges(const EdgeMap& map, std::size_t min_points, const RunContext& run);

}  // namespace landmarkdb
