#include "engine/mono/edge_chains.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/mono/edge_wishes.hpp"
#include "engine/mono/faint_chains.hpp"

namespace landmarkdb {
namespace {

constexpr std::uint32_t kNone = kNoEdgePoint;

struct Links {
  std::vector<std::uint32_t> next;
  std::vector<std::uint32_t> starts{};  // points without a previous one, ascending
};

// Numbers that are chosen without a branch: which of them is as good as chance.
class Chosen {
 public:
  explicit Chosen(std::size_t most)
      : numbers_(std::make_unique_for_overwrite<std::uint32_t[]>(most + 1)) {}

  void clear() { count_ = 0; }
  void add_if(bool wanted, std::uint32_t number) {
    numbers_[count_] = number;  // to be written over where it is not wanted
    count_ += wanted ? 1 : 0;
  }
  std::span<const std::uint32_t> all() const { return {numbers_.get(), count_}; }

 private:
  std::unique_ptr<std::uint32_t[]> numbers_;
  std::size_t count_ = 0;
};

Links link(const std::vector<LinkWishes>& wishes) {
  const auto n = static_cast<std::uint32_t>(wishes.size());
  Links links{std::vector<std::uint32_t>(n, kNone)};
  std::vector<char> has_previous(n + 1, 0);  // one more: for links that lead nowhere
  Chosen left_over(n);
  // First where both want each other, then what is still free on both sides.
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t to = wishes[i].ahead();
    const bool mutual = to != kNone && wishes[to != kNone ? to : i].behind() == i;
    links.next[i] = mutual ? to : kNone;
    has_previous[mutual ? to : n] = 1;
    left_over.add_if(!mutual && to != kNone, i);
  }
  for (const std::uint32_t i : left_over.all()) {
    const std::uint32_t to = wishes[i].ahead();
    if (std::exchange(has_previous[to], 1) == 0) links.next[i] = to;
  }
  left_over.clear();
  for (std::uint32_t i = 0; i < n; ++i) left_over.add_if(has_previous[i] == 0, i);
  for (const std::uint32_t i : left_over.all()) {
    const std::uint32_t from = wishes[i].behind();
    if (from != kNone && links.next[from] == kNone) {
      links.next[from] = i;
    } else {
      links.starts.push_back(i);
    }
  }
  return links;
}

bool ends_meet(const EdgePoint& last, const EdgePoint& first) {
  constexpr float kNear = 3.0F;
  return (first.uv - last.uv).norm() < kNear && last.normal.dot(first.normal) > kLeastLinkCosine;
}

// Follows links from point to point, and collects the chains that are long enough.
class ChainCollector {
 public:
  ChainCollector(const EdgeMap& map, Links links, std::size_t min_points)
      : map_(map), links_(std::move(links)), min_points_(min_points) {}

  EdgeChains collect() {
    const auto n = static_cast<std::uint32_t>(map_.points.size());
    std::size_t followed = 0;
    for (const std::uint32_t i : links_.starts) followed += follow(i, kNone);
    for (std::uint32_t i = 0; i < n && followed < n; ++i) {
      if (links_.next[i] != kDone) followed += follow(i, i);  // what is left runs in circles
    }
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t kDone = kNone - 1;  // where `next` was

  // The points from `start` on until one leads to `end`: how many.
  std::size_t follow(std::uint32_t start, std::uint32_t end) {
    passed_.clear();
    std::uint32_t at = start;
    do {
      passed_.push_back(at);
      at = std::exchange(links_.next[at], kDone);
    } while (at != end);
    if (passed_.size() >= min_points_) add_chain(at == start);
    return passed_.size();
  }

  // Of the points passed.
  void add_chain(bool closed) {
    EdgeChain chain{static_cast<std::uint32_t>(result_.points.size()), 0, false};
    float strongest = 0.0F;
    for (const std::uint32_t i : passed_) {
      strongest = std::max(strongest, map_.contrasts[i]);
      result_.points.push_back(map_.points[i]);
    }
    chain.end = static_cast<std::uint32_t>(result_.points.size());
    chain.closed = closed || ends_meet(result_.points.back(), result_.points[chain.begin]);
    result_.chains.push_back(chain);
    if (strongest < map_.high_contrast) keep_straight_runs(result_, splitter_);
  }

  const EdgeMap& map_;
  Links links_;
  std::size_t min_points_;
  std::vector<std::uint32_t> passed_;  // points, one after the other
  ChainSplitter splitter_;
  EdgeChains result_;
};

}  // namespace

EdgeChains link_edges(const EdgeMap& map, std::size_t min_points, const RunContext& run) {
  return ChainCollector(map, link(find_link_wishes(map, run)), min_points).collect();
}

}  // namespace landmarkdb
