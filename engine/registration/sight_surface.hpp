#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// The surface an entry predicts, in the entry's frame: points, and normals where their side is
// known. Kept in blocks of near points, each in a ball, so that what is out of a view is passed
// over a block at a time, and of what is far from it a part of the points will do. Holds copies.
// Immutable, thread-safe.
class SightSurface {
 public:
  static constexpr std::size_t kBlockPoints = 128;  // at most
  struct Block {
    std::uint32_t begin = 0, end = 0;  // of the points
    std::uint32_t spread_end = 0;      // of those at the beginning that lie twice as far apart
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    float radius_m = 0.0F;  // no point of the block lies further from the centre
  };

  SightSurface() = default;
  // `points` in metres, finite; `normals` one a point, or none; `spacing_m` how far the points lie
  // apart, 0 where none is to be left out. Cost: O(N log N). The same for any number of threads.
  SightSurface(std::span<const Eigen::Vector3f> points,
               std::span<const Eigen::Vector3f> normals = {},
               double spacing_m = 0.0,
               int threads = 1);

  std::size_t size() const { return points_.size(); }
  bool has_normals() const { return !normals_.empty(); }
  std::span<const Eigen::Vector3f> points() const { return points_; }  // block after block
  std::span<const Eigen::Vector3f> normals() const { return normals_; }
  std::span<const Block> blocks() const { return blocks_; }
  std::size_t memory_bytes() const {
    return (points_.size() + normals_.size()) * sizeof(Eigen::Vector3f) +
           blocks_.size() * sizeof(Block);
  }
  // What the surface of so many points takes at most.
  static std::size_t most_bytes(std::size_t points, bool has_normals) {
    return points * (has_normals ? 2 : 1) * sizeof(Eigen::Vector3f) +
           (2 * points / kBlockPoints + 1) * sizeof(Block);
  }

 private:
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;
  std::vector<Block> blocks_;
};

}  // namespace landmarkdb
