#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/depth_camera.hpp"
#include "datasets/objects/object_model.hpp"
#include "datasets/place.hpp"

namespace landmarkdb::datasets {

// Where the things stand, and how closely around them the camera is held.
enum class ObjectGround { kTable, kFloor };

// What sees the scene.
enum class ObjectSensor {
  kDepthCamera,  // DepthCameraOptions as they are
  kScanner,      // a laser triangulation scanner: a tenth of the noise, no steps, no shadows
};

struct ObjectSceneOptions {
  ObjectGround ground = ObjectGround::kTable;
  ObjectSensor sensor = ObjectSensor::kDepthCamera;
  double crowding = 0.5;  // 0: things stand apart .. 1: they touch and hide one another
  double lying = 0.15;    // share of the things that lie on a side
  std::uint64_t seed = 1;
};

// One thing of a scene and what of it can be seen.
struct Standing {
  std::size_t model = 0;  // index into the models given
  Eigen::Isometry3d T_scene_object = Eigen::Isometry3d::Identity();
  std::size_t pixels = 0;  // that show it, of a camera of 640 x 480
  double unhidden = 0.0;   // share of those that would were it alone
};

// A table or a floor with things on it, seen once.
struct ObjectScene {
  Place place;                   // mesh and caster alone
  std::vector<Standing> things;  // in the order of `models`; what found no room is left out
  DepthFrame frame;
};

// Lays the models out around the middle of the ground, one of each, and takes a frame of them. Same
// options, same scene for any number of threads.
ObjectScene make_object_scene(const std::vector<const ObjectModel*>& models,
                              const ObjectSceneOptions& options,
                              const RunContext& context);

}  // namespace landmarkdb::datasets
