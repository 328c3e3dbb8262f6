#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "engine/cloud/cell_grid.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// One keypoint's outcome; `valid` false: no frame or no histogram is defined there.
struct ShotRow {
  bool valid = false;
  Eigen::Matrix3f frame = Eigen::Matrix3f::Identity();  // R_cloud_lrf
};

// SHOT over one cloud and radius. Never changes once built; describe() is thread-safe, and what it
// writes for a place does not depend on the other places it is given.
class ShotDescriber {
 public:
  virtual ~ShotDescriber() = default;

  // Describes the points at `places` of the grid. `rows` has one element a place, `values` one row
  // of kShotLength; the values of rows that are not valid mean nothing.
  virtual void describe(std::span<const std::uint32_t> places,
                        std::span<ShotRow> rows,
                        std::span<float* const> values) const = 0;
};

// Both: `grid` must outlive the describer; `normals[i]` belongs to the point of index i (not
// place). All finite.

// Ours: one neighbour search for frame and histogram, no allocation a keypoint, vector kernels.
std::unique_ptr<ShotDescriber> make_fast_shot(const CellGrid& grid,
                                              std::span<const Eigen::Vector3f> normals,
                                              float radius_m);

// PCL's: the reference.
std::unique_ptr<ShotDescriber> make_pcl_shot(const CellGrid& grid,
                                             std::span<const Eigen::Vector3f> normals,
                                             float radius_m);

}  // namespace landmarkdb
