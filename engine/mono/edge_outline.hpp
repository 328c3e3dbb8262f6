#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/mono/outline_places.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// Which edge directions run near each place of an image: one byte for two by two pixels, a bit for
// each of eight directions. A look-up costs nothing, so thousands of poses can be asked.
class EdgeDirections {
 public:
  explicit EdgeDirections(const ImageFeatures& features);

  bool empty() const { return bits_.empty(); }
  bool inside(const Eigen::Vector2d& uv) const;
  // Whether an edge runs within some 3 px of `uv` (inside the image) along `tangent`, to 30
  // degrees.
  bool runs(const Eigen::Vector2d& uv, const Eigen::Vector2d& tangent) const;

 private:
  std::vector<std::uint8_t> bits_;
  std::size_t columns_ = 0, rows_ = 0;
};

// A model's edges as some dozens of places, with what each view shows of them: what a pose's
// outline is quickly compared by. Built once a model, from the search tables' views of the places.
class EdgeOutline {
 public:
  explicit EdgeOutline(const SearchModel& model);

  // The share of the places visible at a pose that lie on edges of the image; 0 where fewer than a
  // third of them are in it, and as soon as it will not reach `enough`.
  double share(const RigidPose& pose,
               const Camera& camera,
               const EdgeDirections& edges,
               double enough) const;

 private:
  std::vector<OutlinePlace> places_;
  std::vector<std::vector<std::uint16_t>> seen_;  // by view
  Eigen::Vector3d center_;
};

}  // namespace landmarkdb
