#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/cell_grid.hpp"
#include "engine/cloud/moment_sums.hpp"

namespace landmarkdb {

// The plane that points scatter about, by least squares. None for fewer than six points: an
// infinite scatter.
struct ScatterPlane {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, of either sign
  float sigma_m = std::numeric_limits<float>::infinity();
};

// Of more than no points: their mean, from the centre, and how they scatter about it.
Eigen::Vector3f mean_of(const Moments& moments);
Eigen::Matrix3f covariance_of(const Moments& moments);

// Points of a grid side by side, gathered once for the fits around all points of a spot. Belongs to
// one thread; keeps its memory from spot to spot.
class GatheredPoints {
 public:
  // All points of the grid nearer to `centre` than `radius_m`, and others near by.
  void gather(const CellGrid& grid, const Eigen::Vector3f& centre, float radius_m);

  // Of the points nearer to `at` than `radius_m`, all of which must have been gathered.
  Moments moments(const Eigen::Vector3f& at, float radius_m) const;
  ScatterPlane fit_plane(const Eigen::Vector3f& at, float radius_m) const;

  std::size_t size() const { return size_; }
  Eigen::Vector3f point(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

 private:
  std::vector<CellGrid::Run> runs_;
  std::vector<float> x_, y_, z_;  // padded with points far away to whole lanes of moment_sums
  std::size_t size_ = 0;
};

}  // namespace landmarkdb
