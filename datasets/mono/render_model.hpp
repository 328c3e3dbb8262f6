#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/geometry/camera.hpp"
#include "engine/types/grey_image.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb::datasets {

// A model and where the camera sees it.
struct SeenModel {
  const MonoModel* model = nullptr;
  Eigen::Isometry3d T_camera_object = Eigen::Isometry3d::Identity();
};

struct RenderOptions {
  double noise = 2.0;      // grey levels, one sigma
  int clutter = 0;         // polygons and ellipses of random shape behind the models
  double texture = 0.0;    // grey levels of an uneven background, one sigma
  double contrast = 1.0;   // 0: everything is one grey; 1: faces from 60 to 230
  int samples = 6;         // a side of a pixel, where something's border runs through it
  std::uint64_t seed = 1;  // of the faces' shades, the clutter and the noise
};

// A picture of models at exactly known poses: flat faces, each of its own shade, and discs for
// circles, nearer ones before farther ones, through the camera's lens with its distortion, borders
// averaged over their pixels, over a graded background.
//
// Faces are seen from both sides; a circle is a disc upon its face, darker or brighter than that,
// or upon nothing where the model has no faces. Edges that belong to no face are not drawn. Pixels
// that the lens model does not reach show the background. Deterministic.
GreyImage render_models(std::span<const SeenModel> models,
                        const Camera& camera,
                        const RenderOptions& options);
GreyImage render_model(const MonoModel& model,
                       const Camera& camera,
                       const Eigen::Isometry3d& T_camera_object,
                       const RenderOptions& options);

}  // namespace landmarkdb::datasets
