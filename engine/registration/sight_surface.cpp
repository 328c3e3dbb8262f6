#include "engine/registration/sight_surface.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "engine/base/parallel.hpp"
#include "engine/base/put_largest_first.hpp"

namespace landmarkdb {

namespace {

using Order = std::span<std::uint32_t>;

// As a whole number that grows with the value.
std::uint32_t rising(float value) {
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31U;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

// Brings the `half` points that are lowest along the axis to the front. `words` is for its use.
void halve(std::span<const Eigen::Vector3f> points,
           Eigen::Index axis,
           std::size_t half,
           Order order,
           std::vector<std::uint64_t>& words) {
  words.clear();
  for (const std::uint32_t i : order) {
    words.push_back(~(static_cast<std::uint64_t>(rising(points[i][axis])) << 32U | i));
  }
  put_largest_first(words, half);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(~words[i]);
}

// Halves the points across their longest side until each part is a block; the parts stay in order.
// Each half has half of the threads.
void split(std::span<const Eigen::Vector3f> points,
           Order order,
           std::uint32_t begin,
           int threads,
           std::vector<std::uint64_t>& words,
           std::vector<SightSurface::Block>& blocks) {
  Eigen::AlignedBox3f box;
  for (const std::uint32_t i : order) box.extend(points[i]);
  if (order.size() <= SightSurface::kBlockPoints) {
    const std::uint32_t end = begin + static_cast<std::uint32_t>(order.size());
    SightSurface::Block block{begin, end, end, box.center(), 0.0F};
    for (const std::uint32_t i : order) {
      block.radius_m = std::max(block.radius_m, (points[i] - block.centre).norm());
    }
    blocks.push_back(block);
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t half = order.size() / 2;
  halve(points, axis, half, order, words);
  const auto split_half = [&](bool first, int on_threads, auto& own_words, auto& own_blocks) {
    const Order part = first ? order.first(half) : order.subspan(half);
    const auto from = begin + static_cast<std::uint32_t>(first ? 0 : half);
    split(points, part, from, on_threads, own_words, own_blocks);
  };
  if (threads < 2) {
    split_half(true, 1, words, blocks);
    split_half(false, 1, words, blocks);
    return;
  }
  std::vector<SightSurface::Block> of_second;
  std::vector<std::uint64_t> words_of_second;
  parallel_each(2, 2, [&](std::size_t i) {
    const bool first = i == 0;
    const int own = first ? (threads + 1) / 2 : threads / 2;
    split_half(first, own, first ? words : words_of_second, first ? blocks : of_second);
  });
  blocks.insert(blocks.end(), of_second.begin(), of_second.end());
}

// Puts points at least `apart_m` from one another first; returns how many.
std::uint32_t put_spread_first(std::span<const Eigen::Vector3f> points,
                               Order order,
                               float apart_m) {
  std::size_t spread = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Eigen::Vector3f& p = points[order[i]];
    const bool near = std::any_of(
        order.begin(),
        order.begin() + static_cast<std::ptrdiff_t>(spread),
        [&](std::uint32_t other) { return (points[other] - p).squaredNorm() < apart_m * apart_m; });
    if (!near) std::swap(order[spread++], order[i]);
  }
  return static_cast<std::uint32_t>(spread);
}

}  // namespace

SightSurface::SightSurface(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> normals,
                           double spacing_m,
                           int threads) {
  assert((normals.empty() || normals.size() == points.size()) && "one normal a point, or none");
  if (points.empty()) return;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<std::uint64_t> words;
  split(points, order, 0, threads, words, blocks_);
  if (spacing_m > 0.0) {
    constexpr double kApart = 1.6;  // spacings: what is left lies about twice as far apart
    parallel_chunks(blocks_.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (Block& block : std::span(blocks_).subspan(begin, end - begin)) {
        const Order of_block = Order(order).subspan(block.begin, block.end - block.begin);
        block.spread_end =
            block.begin +
            put_spread_first(points, of_block, static_cast<float>(kApart * spacing_m));
      }
    });
  }
  points_.reserve(points.size());
  for (const std::uint32_t i : order) points_.push_back(points[i]);
  normals_.reserve(normals.size());
  for (const std::uint32_t i : order) {
    if (!normals.empty()) normals_.push_back(normals[i]);
  }
}

}  // namespace landmarkdb
