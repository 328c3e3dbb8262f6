#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/edge_points.hpp"

namespace landmarkdb {

// A link that an edge point wishes for: its cost in the upper half, the other point in the lower,
// so that the cheaper one is the smaller number (costs are not negative: their bits are in their
// order).
using LinkWish = std::uint64_t;
inline constexpr LinkWish kNoLinkWish = std::numeric_limits<LinkWish>::max();

// The best link of a point either way along its edge.
struct LinkWishes {
  std::array<LinkWish, 2> ways{kNoLinkWish, kNoLinkWish};  // ahead, behind

  // The other point; kNoEdgePoint where there is none.
  std::uint32_t ahead() const { return static_cast<std::uint32_t>(ways[0]); }
  std::uint32_t behind() const { return static_cast<std::uint32_t>(ways[1]); }
};

inline constexpr std::uint32_t kNoEdgePoint = static_cast<std::uint32_t>(kNoLinkWish);
inline constexpr float kLeastLinkCosine = 0.5F;  // 60 degrees

// The wishes of every point among those whose pixels are within 2 of its own in row and column and
// whose direction turns by less than 60 degrees. Steps aside cost twice as much as steps along the
// edge; points within 0.2 px of each other along it are side by side and wish for no link.
// O(points), and the image's width a row. Throws what `run` throws.
std::vector<LinkWishes> find_link_wishes(const EdgeMap& map, const RunContext& run);

}  // namespace landmarkdb
