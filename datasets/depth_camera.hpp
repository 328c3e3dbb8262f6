#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Geometry>

#include "datasets/place.hpp"
#include "engine/base/run_context.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::datasets {

// The paper's two queries, in points.
inline constexpr std::size_t kPaperTempleQueryPoints = 12'721;
inline constexpr std::size_t kPaperLobbyQueryPoints = 4'097;

// A structured-light camera like the first Kinect. Lens distortion is not simulated: `camera.dist`
// must be zero.
struct DepthCameraOptions {
  Camera camera = {.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  double min_range_m = 0.5;  // of depth z
  double max_range_m = 8.0;
  // Standard deviation of z: noise_floor_m + noise_growth (z - 0.4 m)^2 (Nguyen, Izadi, Lovell
  // 2012).
  double noise_floor_m = 0.0012;
  double noise_growth = 0.0019;
  double noise_scale = 1.0;   // on the whole; 0: none
  bool quantise = true;       // disparity in eighths of a pixel (Khoshelham, Elberink 2012)
  bool shadows = true;        // no depth where the projector, beside the camera, does not reach
  double edge_holes = 0.6;    // share of pixels beside a depth edge that have no depth
  double grazing_rad = 0.17;  // no depth where the surface is seen at a smaller angle than this
  std::uint64_t seed = 1;
};

// One frame with the truth about it.
struct DepthFrame {
  PointCloud cloud;  // organised; camera frame: z forward, x right, y down; no depth: NaN
  Eigen::Isometry3d T_scene_camera;
  Eigen::Vector3d up_camera;  // unit, against gravity
  std::size_t valid = 0;      // pixels with depth
  // Smallest eigenvalue of the mean of n n^T over the true normals seen: 0 for parallel walls, 1/3
  // at most. Frames from 0.03 on fix all six freedoms as a rule.
  double normal_spread = 0.0;
};

// Takes one frame. The same for any number of threads. Throws Error{kInvalidArgument} for a camera
// without pixels or focal length, or one of more than 16 million pixels.
DepthFrame render_depth(const Place& place,
                        const Eigen::Isometry3d& T_scene_camera,
                        const DepthCameraOptions& options,
                        const RunContext& context);

// A small spinning laser: `lines` rings between the two elevations, sensor frame x forward, z up.
struct LidarOptions {
  int lines = 16;
  int columns = 1800;
  double lowest_rad = -0.2618;  // -15 deg .. +15 deg: a common 16-line model
  double highest_rad = 0.2618;
  double noise_m = 0.02;
  double min_range_m = 0.5;
  double max_range_m = 100.0;
  double mixed_pixels = 0.3;
  std::uint64_t seed = 1;
};

// One turn of the laser as an unorganised cloud in its own frame (viewpoint: the origin).
PointCloud render_lidar(const Place& place,
                        const Eigen::Isometry3d& T_scene_lidar,
                        const LidarOptions& options,
                        const RunContext& context);

}  // namespace landmarkdb::datasets
