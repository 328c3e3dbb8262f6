#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/read_cloud.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Zero when float keeps 0.1 mm at `p` (metres); else `p` rounded, for PointCloud::origin.
Eigen::Vector3d round_origin(const Eigen::Vector3d& p);

// Puts a PointCloud together from double coordinates in file units, one point after the other.
//
// The origin is decided from the first points (their median): zero, unless they are so far out that
// float would lose 0.1 mm; then that median, rounded. Not thread-safe.
class CloudBuilder {
 public:
  explicit CloudBuilder(double metres);  // the length of one file unit

  // From now on whole blocks are handed to the sink, which must outlive the builder, and finish
  // returns what is left. `viewpoints` in file units: of every block.
  void hand_to(const CloudSink& sink, std::span<const Eigen::Vector3d> viewpoints);
  // Whether that has happened to a block.
  bool in_blocks() const { return handed_ > 0; }

  void reserve(std::size_t points, bool normals, bool colours);
  // What else a point has is added before the next point.
  void add_point(const Eigen::Vector3d& p_file);
  void add_normal(const Eigen::Vector3d& n_file);
  void add_colour(const std::array<std::uint8_t, 3>& colour);
  void add_viewpoint_index(std::uint16_t index);
  std::size_t size() const { return handed_ + cloud_.points.size() + pending_.size(); }

  // The builder is empty afterwards.
  PointCloud finish();

 private:
  void decide_origin();
  void reserve_block();
  PointCloud take_block();

  double metres_;
  bool decided_ = false;
  std::vector<Eigen::Vector3d> pending_;  // metres; until the origin is decided
  PointCloud cloud_;
  const CloudSink* sink_ = nullptr;
  std::vector<Eigen::Vector3d> viewpoints_;  // of the sink's blocks
  std::size_t handed_ = 0;                   // points
  std::size_t expected_ = 0;                 // what is reserved for, of all blocks together
  bool normals_ = false, colours_ = false;
};

}  // namespace landmarkdb
