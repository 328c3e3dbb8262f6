#include "engine/mono/edge_chains.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/mono/faint_chains.hpp"

namespace landmarkdb {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr float kLeastCosine = 0.5F;  // 60 degrees
constexpr std::int32_t kReach = 2;    // pixels

// A link that a point wishes for: its cost in the upper half, the other point in the lower, so that
// the cheaper one is the smaller number (costs are not negative: their bits are in their order).
using Wish = std::uint64_t;
constexpr Wish kNoWish = std::numeric_limits<Wish>::max();
struct Wishes {
  std::array<Wish, 2> ways{kNoWish, kNoWish};  // ahead, behind

  std::uint32_t ahead() const { return static_cast<std::uint32_t>(ways[0]); }
  std::uint32_t behind() const { return static_cast<std::uint32_t>(ways[1]); }
};
static_assert(static_cast<std::uint32_t>(kNoWish) == kNone);

// What point p thinks of a link to q, which lies `step` away. No branches: which way a point lies
// is as good as chance.
void consider(const EdgePoint& p, const Eigen::Vector2f& step, std::uint32_t q, Wishes& wishes) {
  const float along = -p.normal.y() * step.x() + p.normal.x() * step.y();
  const float aside = p.normal.dot(step);
  const float cost = along * along + 2.0F * aside * aside;
  constexpr float kLeastStep = 0.2F;  // below, the two are side by side
  const Wish wish = (Wish{std::bit_cast<std::uint32_t>(cost)} << 32U) | q;
  Wish& known = wishes.ways[along < 0.0F ? 1 : 0];
  known = std::abs(along) > kLeastStep ? std::min(known, wish) : known;
}

void consider_both(const EdgeMap& map,
                   std::uint32_t i,
                   std::uint32_t j,
                   std::vector<Wishes>& wishes) {
  const EdgePoint &p = map.points[i], &q = map.points[j];
  if (p.normal.dot(q.normal) < kLeastCosine) return;
  const Eigen::Vector2f step = q.uv - p.uv;
  consider(p, step, j, wishes[i]);
  consider(q, -step, i, wishes[j]);
}

// The best link of every point either way. Every pair is looked at once, from the upper or left
// one; each row below has a cursor that only moves on, so no map of the image is needed.
std::vector<Wishes> find_wishes(const EdgeMap& map, const RunContext& run) {
  std::vector<Wishes> wishes(map.points.size());
  const std::size_t height = map.row_starts.size() - 1;
  for (std::size_t y = 0; y < height; ++y) {
    constexpr std::size_t kRowsBetweenChecks = 64;
    if (y % kRowsBetweenChecks == 0) run.check("features");
    std::array<std::uint32_t, kReach> cursors{}, ends{};
    for (std::size_t below = 0; below < kReach && y + below + 1 < height; ++below) {
      cursors[below] = map.row_starts[y + below + 1];
      ends[below] = map.row_starts[y + below + 2];
    }
    for (std::uint32_t i = map.row_starts[y]; i < map.row_starts[y + 1]; ++i) {
      const std::int32_t first = map.columns[i] - kReach, last = map.columns[i] + kReach;
      for (std::uint32_t j = i + 1; j < map.row_starts[y + 1] && map.columns[j] <= last; ++j) {
        consider_both(map, i, j, wishes);
      }
      for (std::size_t below = 0; below < kReach; ++below) {
        const std::uint32_t end = ends[below];
        std::uint32_t& at = cursors[below];
        while (at < end && map.columns[at] < first) ++at;
        for (std::uint32_t j = at; j < end && map.columns[j] <= last; ++j) {
          consider_both(map, i, j, wishes);
        }
      }
    }
  }
  return wishes;
}

struct Links {
  std::vector<std::uint32_t> next, previous;
};

Links link(const std::vector<Wishes>& wishes) {
  Links links{std::vector<std::uint32_t>(wishes.size(), kNone),
              std::vector<std::uint32_t>(wishes.size(), kNone)};
  const auto join = [&](std::uint32_t from, std::uint32_t to) {
    links.next[from] = to;
    links.previous[to] = from;
  };
  // First where both want each other, then what is still free on both sides.
  for (std::uint32_t i = 0; i < wishes.size(); ++i) {
    const std::uint32_t to = wishes[i].ahead();
    if (to != kNone && wishes[to].behind() == i) join(i, to);
  }
  for (std::uint32_t i = 0; i < wishes.size(); ++i) {
    const std::uint32_t to = wishes[i].ahead();
    if (to != kNone && links.next[i] == kNone && links.previous[to] == kNone) join(i, to);
  }
  for (std::uint32_t i = 0; i < wishes.size(); ++i) {
    const std::uint32_t from = wishes[i].behind();
    if (from != kNone && links.previous[i] == kNone && links.next[from] == kNone) join(from, i);
  }
  return links;
}

bool ends_meet(const EdgePoint& last, const EdgePoint& first) {
  constexpr float kNear = 3.0F;
  return (first.uv - last.uv).norm() < kNear && last.normal.dot(first.normal) > kLeastCosine;
}

}  // namespace

EdgeChains link_edges(const EdgeMap& map, std::size_t min_points, const RunContext& run) {
  const Links links = link(find_wishes(map, run));
  EdgeChains result;
  std::vector<bool> used(map.points.size(), false);
  const auto follow = [&](std::uint32_t start) {
    EdgeChain chain{static_cast<std::uint32_t>(result.points.size()), 0, false};
    float strongest = 0.0F;
    std::uint32_t at = start;
    for (; at != kNone && !used[at]; at = links.next[at]) {
      used[at] = true;
      strongest = std::max(strongest, map.contrasts[at]);
      result.points.push_back(map.points[at]);
    }
    chain.end = static_cast<std::uint32_t>(result.points.size());
    if (chain.end - chain.begin < min_points) {
      result.points.resize(chain.begin);
      return;
    }
    chain.closed = at == start || ends_meet(result.points.back(), result.points[chain.begin]);
    result.chains.push_back(chain);
    if (strongest < map.high_contrast) keep_straight_runs(result);
  };
  for (std::uint32_t i = 0; i < map.points.size(); ++i) {
    if (links.previous[i] == kNone) follow(i);
  }
  for (std::uint32_t i = 0; i < map.points.size(); ++i) {
    if (!used[i]) follow(i);  // what is left runs in circles
  }
  return result;
}

}  // namespace landmarkdb
