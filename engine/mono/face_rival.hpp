#pragma once

#include <optional>
#include <span>

#include "engine/geometry/camera.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// A model's point that was matched: its number, where it is seen and how well.
struct SeenCorner {
  std::uint32_t point = 0;
  Eigen::Vector2d uv;
  double sigma_px = 1.0;
};

// A place on a model's edge and the image edge it is held for.
struct SeenEdge {
  EdgeSample sample;
  Eigen::Vector2d uv;
};

// What the places of a model's faces say for it: the odds (log10, positive for the model) of the
// faces standing where the model has them, within how things follow their models, against anywhere
// along their normals, as in another body of its kind. What the view does not show says nothing,
// nor do size and distance, which cannot be told apart: of a box two proportions are left, of a
// body of more faces more. nullopt for models without faces, or with more than a few dozen. 0.1 ms.
std::optional<double> face_rival(const SearchModel& model,
                                 const Camera& camera,
                                 const RigidPose& pose,
                                 std::span<const SeenCorner> corners,
                                 std::span<const SeenEdge> edges);

}  // namespace landmarkdb
