#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/registration/icp.hpp"
#include "engine/registration/range_image.hpp"
#include "engine/registration/scanned_space.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

// What a pose explains, and what speaks against it. Shares are 0..1.
struct Evidence {
  double overlap = 0.0;    // of the source points: on the target's surface, normals agreeing
  double balanced = 0.0;   // the same, each surface direction weighted alike
  double rmse_m = 0.0;     // of those points, to the surface
  double explained = 0.0;  // of the directions where the entry predicts a range: it agrees
  double refuted = 0.0;    // of the source points: where the target is known to be empty
  double crossed = 0.0;    // of the same: the sensor looked through the entry's surface
  double coverage = 0.0;   // of the directions measured: the entry predicts a range
  // Of the directions predicted, of an object those of them that nothing hides: in an area of them
  // all is contradicted.
  double contradicted = 0.0;
  double observability =
      0.0;  // weakest freedom: 0 none (a plane), 1 as strong as it gets (a ball of normals)
  double agreeing = 0.0;  // the query's keypoints of which a descriptor pair agrees
  double contrast =
      1.0;  // -1..1: of what tells the pose from its nearest rival, for it less against
  // Of an object: the share of its outline at which the query's surface goes on flush beyond it, as
  // a larger thing's does.
  double outgrown = 0.0;
  // Of an object's surface that must be seen.
  double seen_points = 0.0;  // how many points that is
  double closeness = 0.0;    // 0..1: how closely it lies on the surface measured
  double structure = 0.0;    // 0..1: how evenly the normals of what lies on it are spread
  double confirmed = 0.0;    // of its keypoints: a descriptor pair agrees
  // Of an object's outline: the surface measured goes on beyond it at the same range.
  double continued = 0.0;
  bool of_object = false;  // measured on an object in the query, not on the query in a place
  Eigen::Vector3d strength =
      Eigen::Vector3d::Zero();  // share of the normals' scatter along x, y, z, target frame
};

struct VerifyOptions {
  double surface_tolerance_cells =
      0.75;                            // plane distance at which a point still lies on the surface
  double min_normal_agreement = 0.7;   // cosine, 45 deg
  double sight_tolerance_cells = 2.0;  // for free space, plus the next
  double sight_tolerance_range =
      0.02;  // share of the range: a depth camera's noise, and the angle of a cell
  // Of this tolerance, what an area must be off by to be contradicted.
  double contradiction_share = 1.0;
  // Whether a surface before which something was measured is contradicted: not where clutter may
  // stand before it.
  bool hidden_contradicts = true;
};

// Measures how many of the source's points lie on the target's surface under the pose, and how many
// where it is known to be empty, as `scanned` (null: nobody knows) tells.
void measure_overlap(const SurfaceGrid& target,
                     std::span<const Eigen::Vector3f> source,
                     std::span<const Eigen::Vector3f> source_normals,
                     const Eigen::Isometry3d& T_target_source,
                     const ScannedSpace* scanned,
                     const VerifyOptions& options,
                     Evidence& evidence);

// Measures how the entry's surface agrees with what the sensor saw and saw through. `entry` are
// points of the stored entry, `T_sensor_entry` carries them into the sensor frame of `ranges`, of
// which there is one for each viewpoint.
void measure_sight(std::span<const RangeImage> ranges,
                   const SightSurface& entry,
                   const Eigen::Isometry3d& T_sensor_entry,
                   double cell_m,
                   const VerifyOptions& options,
                   Evidence& evidence);

// How well the paired surface fixes all six freedoms: the smallest eigenvalue of the information
// per pair, rotation scaled to the pairs' own extent, times three (a ball of evenly spread normals
// gives 1).
double observability(const IcpResult& icp, double source_extent_m, std::size_t source_points);

}  // namespace landmarkdb
