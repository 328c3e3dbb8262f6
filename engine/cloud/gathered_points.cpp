#include "engine/cloud/gathered_points.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Eigenvalues>

namespace landmarkdb {

namespace {

// Squares to infinity: near to nothing.
constexpr float kFarAway = 1e30F;

void append(std::span<const float> from, const CellGrid::Run& run, std::vector<float>& to) {
  to.insert(to.end(), from.begin() + run.begin, from.begin() + run.end);
}

void pad(std::vector<float>& values) {
  values.resize((values.size() + kMomentLanes - 1) / kMomentLanes * kMomentLanes, kFarAway);
}

}  // namespace

Eigen::Vector3f mean_of(const Moments& moments) {
  return Eigen::Vector3f(moments.sum[0], moments.sum[1], moments.sum[2]) / moments.count;
}

Eigen::Matrix3f covariance_of(const Moments& moments) {
  const auto& p = moments.products;
  Eigen::Matrix3f squares;
  squares << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  const Eigen::Vector3f mean = mean_of(moments);
  return squares / moments.count - mean * mean.transpose();
}

void GatheredPoints::gather(const CellGrid& grid, const Eigen::Vector3f& centre, float radius_m) {
  grid.runs(centre, radius_m, runs_);
  x_.clear();
  y_.clear();
  z_.clear();
  for (const CellGrid::Run& run : runs_) {
    append(grid.x(), run, x_);
    append(grid.y(), run, y_);
    append(grid.z(), run, z_);
  }
  size_ = x_.size();
  pad(x_);
  pad(y_);
  pad(z_);
}

Moments GatheredPoints::moments(const Eigen::Vector3f& at, float radius_m) const {
  static const MomentSums add_up = moment_sums();
  return add_up(x_.data(), y_.data(), z_.data(), x_.size(), at.data(), radius_m * radius_m);
}

ScatterPlane GatheredPoints::fit_plane(const Eigen::Vector3f& at, float radius_m) const {
  constexpr float kFewest = 6.0F;
  const Moments moments = this->moments(at, radius_m);
  ScatterPlane plane;
  if (moments.count < kFewest) return plane;
  const Eigen::Vector3f mean = mean_of(moments);
  const Eigen::Matrix3f covariance = covariance_of(moments);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  plane.mean = at + mean;
  plane.normal = solver.eigenvectors().col(0);
  if (plane.normal.allFinite()) {
    plane.sigma_m = std::sqrt(std::max(solver.eigenvalues()(0), 0.0F));
  }
  return plane;
}

}  // namespace landmarkdb
