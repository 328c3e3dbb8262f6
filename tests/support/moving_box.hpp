#pragma once

#include <memory>
#include <string>

#include <Eigen/Geometry>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb::testing {

// A box on its way past a camera (640 x 480, f 600, k1 -0.15), one step a frame.
struct MovingBox {
  MovingBox();

  // The top with its circle and two sides are seen; frames from 0 on, 3 mm and 0.6 degrees apart.
  Eigen::Isometry3d T_camera_object(int frame) const;
  // What a perfect detector would find: each seen point where its image is measured, and their
  // links.
  ImageFeatures features(int frame) const;

  std::shared_ptr<const MonoModelRecord> record;  // named "box"
  Camera camera;
};

// An arm file for it: a PUMA 560 that should see the box as in frame `frame`.
std::string arm_file(const MovingBox& box, int frame);

}  // namespace landmarkdb::testing
