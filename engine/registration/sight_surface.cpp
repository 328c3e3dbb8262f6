#include "engine/registration/sight_surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

constexpr std::size_t kBlockPoints = 128;

using Order = std::span<std::uint32_t>;

// Halves the points across their longest side until each part is a block; the parts stay in order.
void split(std::span<const Eigen::Vector3f> points,
           Order order,
           std::uint32_t begin,
           std::vector<SightSurface::Block>& blocks) {
  Eigen::AlignedBox3f box;
  for (const std::uint32_t i : order) box.extend(points[i]);
  if (order.size() <= kBlockPoints) {
    SightSurface::Block block{
        begin, begin + static_cast<std::uint32_t>(order.size()), box.center(), 0.0F};
    for (const std::uint32_t i : order) {
      block.radius_m = std::max(block.radius_m, (points[i] - block.centre).norm());
    }
    blocks.push_back(block);
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(),
                   order.begin() + static_cast<std::ptrdiff_t>(half),
                   order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis]
                                                               : a < b;
                   });
  split(points, order.first(half), begin, blocks);
  split(points, order.subspan(half), begin + static_cast<std::uint32_t>(half), blocks);
}

}  // namespace

SightSurface::SightSurface(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> normals) {
  assert((normals.empty() || normals.size() == points.size()) && "one normal a point, or none");
  if (points.empty()) return;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  split(points, order, 0, blocks_);
  points_.reserve(points.size());
  for (const std::uint32_t i : order) points_.push_back(points[i]);
  normals_.reserve(normals.size());
  for (const std::uint32_t i : order) {
    if (!normals.empty()) normals_.push_back(normals[i]);
  }
}

}  // namespace landmarkdb
