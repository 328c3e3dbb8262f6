#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/visibility.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// A place on a model's edge or circle that a pose shows, to be looked for in the image.
struct TrackSample {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();      // metres, object frame
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();       // where the pose puts it, pixels
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // unit, across the edge in the image
  std::uint32_t curve = 0;  // the edge, or (number of edges + k) for circle k
  double share = 0.0;       // how far along it, 0 to 1
  // Another curve runs so close beside it that their images may be taken for one another.
  bool crowded = false;
};

struct TrackSampleOptions {
  double step_px = 6.0;    // between samples of one edge
  double end_px = 3.0;     // left out at an edge's ends, where other edges meet it
  double border_px = 3.0;  // of the image, left out
  double crowd_px = 6.0;   // curves nearer than this and nearly parallel crowd each other
  std::size_t most = 400;  // in all; the step grows where there would be more
};

// The visible parts of all edges and circles at a pose, edges first, each from one end to the
// other. What is hidden by a face, behind the camera, outside the image or the lens model is left
// out.
std::vector<TrackSample> track_samples(const MonoModel& model,
                                       const ModelVisibility& visibility,
                                       const Camera& camera,
                                       const RigidPose& pose,
                                       const TrackSampleOptions& options);

}  // namespace landmarkdb
