#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/registration/range_image.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

// The space a place's scanner looked through, as its points and their viewpoints tell: it is empty.
// What the scanner neither met nor looked through nobody knows: a surface that a robot sees there
// speaks neither for a pose nor against it. Immutable, thread-safe.
class ScannedSpace {
 public:
  ScannedSpace() = default;
  // `points` and `viewpoints` in metres, the frame of `surface`, the grid of the same points;
  // `viewpoint_index` names the viewpoint of each point, or is empty where there is one. A
  // viewpoint from which its points cannot have been seen, as the grid tells, is passed over: files
  // of merged scans give the first one's, or zero. What lies less than three cells before what was
  // measured, along the ray, is not called empty.
  ScannedSpace(std::span<const Eigen::Vector3f> points,
               std::span<const Eigen::Vector3f> viewpoints,
               std::span<const std::uint16_t> viewpoint_index,
               const SurfaceGrid& surface);

  // Whether there is a viewpoint; without one nothing is known to be empty.
  bool known() const { return !images_.empty(); }
  bool is_empty_at(const Eigen::Vector3f& p) const;
  std::size_t memory_bytes() const;

 private:
  float slack_m_ = 0.0F;
  std::vector<RangeImage> images_;
};

}  // namespace landmarkdb
