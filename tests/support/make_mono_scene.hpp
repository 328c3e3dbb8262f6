#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb::testing {

struct MonoModelOptions {
  std::uint64_t seed = 1;
  std::size_t least_points = 8, most_points = 30;
  std::size_t types = 3;        // feature types are drawn from the first so many
  double share_of_edges = 1.0;  // of the sides of the faces
};

// A convex body with typed corners, triangular outward faces and edges, some 0.2 m across.
std::shared_ptr<const MonoModelRecord> make_mono_model(const MonoModelOptions& options);

// A catalogue of `count` of them, with seeds from options.seed on, named model0, model1, ...
std::shared_ptr<const MonoCatalog> make_mono_catalog(const MonoModelOptions& options,
                                                     std::size_t count);

struct MonoSceneOptions {
  std::uint64_t seed = 1;
  std::size_t features = 60;    // in the image, clutter included
  double clutter_share = -1.0;  // above zero: this share of the features, instead of `features`
  double noise_px = 1.0;
  double missing = 0.3;         // of the visible points
  double missing_links = 0.15;  // of the links between points that were found
  bool links = true;
  bool directions = false;  // of the edges at each feature, to 3 degrees
  bool edges = false;       // edge points too, to 0.3 px, with straight clutter
  std::size_t types = 3;    // of the clutter
  double near_m = 0.5, far_m = 1.2;
};

struct MonoScene {
  Camera camera;
  ImageFeatures features;
  RigidPose truth;
  std::size_t true_features = 0;          // they come first
  std::vector<std::uint32_t> model_of{};  // of each, the model's point
};

// An image (640 x 480, f 600) of a model among clutter; without a model (nullptr) of clutter alone.
MonoScene make_mono_scene(const MonoModelRecord* model, const MonoSceneOptions& options);

}  // namespace landmarkdb::testing
