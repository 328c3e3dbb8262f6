#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

struct Neighbour {
  std::uint32_t index = 0;
  float squared_distance_m2 = 0.0F;
};

// A kd-tree over points (nanoflann), exact. Keeps a copy of nothing: `points` must outlive it.
// Const methods are thread-safe. Results are the same on every run; ties are broken by the lower
// index.
class SpatialIndex {
 public:
  // Throws what `context.check` does.
  explicit SpatialIndex(std::span<const Eigen::Vector3f> points, const RunContext& context = {});
  ~SpatialIndex();
  SpatialIndex(SpatialIndex&&) noexcept;
  SpatialIndex& operator=(SpatialIndex&&) noexcept;

  // The `k` nearest points, nearest first (fewer when there are fewer). `out` is overwritten.
  void nearest(const Eigen::Vector3f& query, std::size_t k, std::vector<Neighbour>& out) const;

  // All points within `radius_m`, by ascending distance, then index. `out` is overwritten.
  void within(const Eigen::Vector3f& query, float radius_m, std::vector<Neighbour>& out) const;

  // The same points in the order of the tree (fixed for given points), without the cost of sorting.
  void within_unordered(const Eigen::Vector3f& query,
                        float radius_m,
                        std::vector<Neighbour>& out) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace landmarkdb
