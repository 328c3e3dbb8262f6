#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/retrieval/index_options.hpp"
#include "engine/retrieval/scan_gatherer.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// One scan of the place, as read from a file (metres), with its pose in the scene frame.
struct Scan {
  PointCloud cloud;
  Eigen::Isometry3d T_scene_cloud = Eigen::Isometry3d::Identity();
  std::string source;  // file name, for the record
};

// What indexing would take, from a look at the points alone.
struct IndexEstimate {
  FeatureOptions options;
  std::uint64_t points = 0, points_used = 0, keypoints = 0, database_bytes = 0;
  std::uint64_t memory_bytes = 0;  // while it is indexed
  std::uint64_t served_bytes = 0;  // in a server: the arrays, and the grid that poses are tested on
  double seconds = 0.0;
};

// Turns scans into a scene record: derive the working resolution, prepare, detect keypoints,
// describe. `scans` is consumed; the options are those they were gathered for. Reports the stages
// "prepare", "keypoints", "describe". Throws Error{kInvalidArgument} when nothing is left to
// describe (too few points, all on one plane or line) with what was counted, or for a voxel so
// small that no server could hold the scene's grid, with the figures; Error{kResourceExhausted}
// when the cells that the scans were condensed to turn out too coarse for the working resolution;
// Error{kCancelled} on a stop request.
SceneRecord describe_scene(std::string name,
                           GatheredScans scans,
                           const IndexOptions& options,
                           const RunContext& context);

// The same of scans that are in memory, gathered first; reports the stage "sanitise" too.
SceneRecord describe_scene(std::string name,
                           std::vector<Scan> scans,
                           const IndexOptions& options,
                           const RunContext& context);

// The same as far as the working resolution, then an extrapolation; cheap. Refuses the same.
IndexEstimate estimate_index(GatheredScans scans,
                             const IndexOptions& options,
                             const RunContext& context);
IndexEstimate estimate_index(std::vector<Scan> scans,
                             const IndexOptions& options,
                             const RunContext& context);

}  // namespace landmarkdb
