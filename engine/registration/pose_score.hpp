#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/base/fast_exp.hpp"
#include "engine/registration/plane_pairs.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

// Points that stand for a cloud in a quick test, most telling first: any prefix is a fair sample.
class TestPoints {
 public:
  TestPoints() = default;
  // One unit normal a point.
  TestPoints(std::vector<Eigen::Vector3f> points, std::vector<Eigen::Vector3f> normals)
      : points_(std::move(points)), normals_(std::move(normals)), groups_(points_, normals_) {}

  std::size_t size() const { return points_.size(); }
  std::span<const Eigen::Vector3f> points() const { return points_; }
  std::span<const Eigen::Vector3f> normals() const { return normals_; }
  const PointGroups& groups() const { return groups_; }  // of the same

 private:
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;
  PointGroups groups_;
};

// Draws up to `count` points so that rare surface directions are not drowned by floors and walls: a
// point's chance falls with the square root of how common its normal's direction is (after the
// normal-space sampling of Rusinkiewicz and Levoy 2001), and rises with its `weights`, one a point
// or none at all. Same seed, same cloud: same points.
TestPoints select_test_points(std::span<const Eigen::Vector3f> points,
                              std::span<const Eigen::Vector3f> normals,
                              std::span<const float> weights,
                              std::size_t count,
                              std::uint64_t seed);

struct ScoreOptions {
  float sigma_cells = 1.0F;  // of the plane distance, in cells of the grid
  // Points after which a hopeless pose is given up, rounded up to whole groups of 16.
  std::size_t first_look = 32;
  float hopeless = 0.15F;  // mean score of the first look below which it is
};

// How well one point lies on the surface: max(0, n.n') exp(factor d^2), d the distance to the plane
// of the surface near, factor = -1 / (2 sigma^2); 0 where there is none.
inline float surface_fit(const SurfaceGrid& target,
                         const Eigen::Vector3f& p,
                         const Eigen::Vector3f& normal,
                         float factor) {
  const Surfel& surfel = target.near_or_none(p);
  const float agreement = std::max(surfel.normal.dot(normal), 0.0F);
  const float distance = surfel.normal.dot(p - surfel.point);
  return agreement * exp_of_negative(factor * distance * distance);
}

// How well the points lie on the surface under the pose: the mean over the first `count` test
// points (rounded up to whole groups of 16) of max(0, n.n') exp(-d^2 / 2 sigma^2), d the distance
// to the plane of the surface near; 0..1. A pose given up at the first look gets that look's score
// minus one (below 0).
float score_pose(const SurfaceGrid& target,
                 const TestPoints& test,
                 std::size_t count,
                 const Eigen::Matrix3f& R_target_source,
                 const Eigen::Vector3f& t_target_source,
                 const ScoreOptions& options);

}  // namespace landmarkdb
