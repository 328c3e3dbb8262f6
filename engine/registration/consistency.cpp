#include "engine/registration/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace landmarkdb {

namespace {

// Rows of bits: row i has bit j where pairs i and j agree.
class CompatibilityGraph {
 public:
  explicit CompatibilityGraph(std::size_t n)
      : n_(n), words_((n + 63) / 64), bits_(n_ * words_, 0), degree_(n, 0) {}

  void connect(std::size_t i, std::size_t j) {
    bits_[i * words_ + j / 64] |= std::uint64_t{1} << (j % 64);
    bits_[j * words_ + i / 64] |= std::uint64_t{1} << (i % 64);
    ++degree_[i];
    ++degree_[j];
  }
  bool connected(std::size_t i, std::size_t j) const {
    return ((bits_[i * words_ + j / 64] >> (j % 64)) & 1U) != 0;
  }
  std::size_t degree(std::size_t i) const { return degree_[i]; }
  std::size_t size() const { return n_; }

 private:
  std::size_t n_, words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::size_t> degree_;
};

CompatibilityGraph compatibility(std::span<const Correspondence> pairs,
                                 std::span<const Eigen::Vector3f> target,
                                 std::span<const Eigen::Vector3f> source,
                                 const ConsistencyOptions& options) {
  CompatibilityGraph graph(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      const float there = (target[pairs[i].target] - target[pairs[j].target]).norm();
      const float here = (source[pairs[i].query] - source[pairs[j].query]).norm();
      if (here < options.min_separation_m || std::abs(there - here) > options.tolerance_m) continue;
      graph.connect(i, j);
    }
  }
  return graph;
}

// Vertices by falling degree; ties by index, so that the result repeats.
std::vector<std::size_t> by_degree(const CompatibilityGraph& graph) {
  std::vector<std::size_t> order(graph.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return graph.degree(a) > graph.degree(b);
  });
  return order;
}

std::vector<std::size_t> grow_clique(const CompatibilityGraph& graph,
                                     std::span<const std::size_t> order,
                                     std::size_t seed) {
  std::vector<std::size_t> clique{seed};
  for (const std::size_t candidate : order) {
    const bool agrees =
        candidate != seed && std::all_of(clique.begin(), clique.end(), [&](std::size_t member) {
          return graph.connected(member, candidate);
        });
    if (agrees) clique.push_back(candidate);
  }
  return clique;
}

}  // namespace

std::vector<Correspondence> filter_consistency(std::span<const Correspondence> correspondences,
                                               std::span<const Eigen::Vector3f> target,
                                               std::span<const Eigen::Vector3f> source,
                                               const ConsistencyOptions& options) {
  std::vector<std::size_t> chosen(correspondences.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::stable_sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) {
    return correspondences[a].distance < correspondences[b].distance;
  });
  chosen.resize(std::min(chosen.size(), options.max_pairs));
  std::sort(chosen.begin(), chosen.end());
  std::vector<Correspondence> pairs;
  for (const std::size_t i : chosen) pairs.push_back(correspondences[i]);

  const CompatibilityGraph graph = compatibility(pairs, target, source, options);
  const std::vector<std::size_t> order = by_degree(graph);
  constexpr std::size_t kSeeds = 50;  // bounds the cost at 50 n^2 / 2 look-ups
  std::vector<std::size_t> best;
  for (std::size_t s = 0; s < std::min(kSeeds, order.size()); ++s) {
    if (graph.degree(order[s]) < best.size()) break;  // no larger clique can hold this vertex
    std::vector<std::size_t> clique = grow_clique(graph, order, order[s]);
    if (clique.size() > best.size()) best = std::move(clique);
  }
  if (best.size() < 3) return {};
  std::sort(best.begin(), best.end());
  std::vector<Correspondence> kept;
  for (const std::size_t i : best) kept.push_back(pairs[i]);
  return kept;
}

}  // namespace landmarkdb
