#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/place.hpp"

namespace landmarkdb::datasets {

struct PoseSampling {
  double lowest_eye_m = 0.8, highest_eye_m = 1.8;             // above the floor
  double lowest_pitch_rad = -0.45, highest_pitch_rad = 0.25;  // of the view; positive looks up
  double roll_rad = 0.05;    // standard deviation; a camera held by hand or on a robot
  bool any_roll = false;     // roll uniform over the whole turn instead
  double clearance_m = 0.5;  // nothing nearer than this on any side
  double min_valid = 0.3;    // share of the view with a surface at 0.5 to 8 m
  int floor = -1;            // only this storey; -1: all
};

// `count` camera poses T_scene_camera (z forward, x right, y down) at free places of the building,
// never inside a solid. The i-th pose depends on place, seed and i only.
//
// Throws Error{kInvalidArgument} when no free place is found: the place is too cluttered for what
// is asked.
std::vector<Eigen::Isometry3d> sample_camera_poses(const Place& place,
                                                   std::size_t count,
                                                   std::uint64_t seed,
                                                   const PoseSampling& sampling = {});

// The same for a sensor that stands upright, x forward, z up (a laser on a robot).
std::vector<Eigen::Isometry3d> sample_upright_poses(const Place& place,
                                                    std::size_t count,
                                                    std::uint64_t seed,
                                                    const PoseSampling& sampling = {});

// True when the point is in the open: no surface within `clearance_m` on any of a fan of rays, and
// none of them ends on the inner side of a solid.
bool is_free(const RayCaster& caster, const Eigen::Vector3d& p_scene, double clearance_m);

}  // namespace landmarkdb::datasets
