#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "datasets/mono/render_model.hpp"

namespace landmarkdb::datasets {

// A flat piece of something, bounded by a polygon, as the camera's rays (x, y at z = 1) see it.
struct Surface {
  std::vector<Eigen::Vector2d> outline{};  // of the polygon's projection, corner after corner
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  // its box
  Eigen::Vector3d inverse_depth = Eigen::Vector3d::Zero();  // 1 / z = this . (x, y, 1)
  double lift = 0.0;  // adds to 1 / z where surfaces lie in one plane: the higher one is seen
  double grey = 0.0;
};

// The faces and circles of a model. Pieces that reach behind the camera are left out.
void add_model(const SeenModel& seen,
               const RenderOptions& options,
               std::uint64_t seed,
               std::vector<Surface>& surfaces);

// Polygons and ellipses of random size and shade behind everything.
void add_clutter(const Camera& camera,
                 const RenderOptions& options,
                 std::vector<Surface>& surfaces);

// The index of the surface that a ray meets first; -1: none.
int first_surface(std::span<const Surface> surfaces,
                  std::span<const int> among,
                  const Eigen::Vector2d& ray);

}  // namespace landmarkdb::datasets
