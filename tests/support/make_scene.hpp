#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/geometry/camera.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::testing {

// A made-up furnished room, scanned. Metres, z up, one corner of the floor at zero.
struct SceneOptions {
  std::uint64_t seed = 1;                            // room size, furniture and noise
  std::uint32_t furniture = 22;                      // boxes and balls beside the walls
  std::uint32_t stations = 4;                        // where the scanner stood
  std::uint32_t rays = 60'000;                       // per station, evenly over the sphere
  double noise_m = 0.003;                            // standard deviation along the ray
  Eigen::Vector3d room_m = Eigen::Vector3d::Zero();  // inner size; zero: drawn from the seed
};

// A box turned about z, or a ball (radius: half_m.x()).
struct Solid {
  bool ball = false;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};

struct SyntheticScene {
  Eigen::Vector3d room_m = Eigen::Vector3d::Zero();
  std::vector<Solid> solids;
  std::vector<PointCloud> scans;  // one a station, scene frame, with its viewpoint
  PointCloud cloud;               // all of them, with viewpoints and viewpoint_index
};

// The same options: the same scene, bit for bit.
SyntheticScene make_scene(const SceneOptions& options);

// Distance along the unit `direction` to the first surface, from a place inside the room.
double first_hit_m(const SyntheticScene& scene,
                   const Eigen::Vector3d& from,
                   const Eigen::Vector3d& direction);

// What a depth camera at T_scene_sensor (x right, y down, z forward) sees: an organised cloud in
// the sensor frame; nothing behind a nearer surface is in it. Pixels beyond `max_range_m` are NaN.
struct ViewOptions {
  std::uint64_t seed = 1;
  Camera camera{.width = 160, .height = 120, .fx = 130, .fy = 130, .cx = 79.5, .cy = 59.5};
  double noise_m = 0.003;
  double max_range_m = 8.0;
};
PointCloud view_of(const SyntheticScene& scene,
                   const Eigen::Isometry3d& T_scene_sensor,
                   const ViewOptions& options);

// The optical frame of a camera at `eye` that looks at `target`, upright.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

// A pose inside the room, drawn from `seed`, with room in front of the lens and furniture in sight.
Eigen::Isometry3d make_view_pose(const SyntheticScene& scene, std::uint64_t seed);

}  // namespace landmarkdb::testing
