#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

struct PrepareOptions {
  double voxel_m = 0.0;          // > 0
  double normal_radius_m = 0.0;  // > 0
  bool without_strays = false;   // drop what hangs alone in the air (drop_strays)
};

// Thins a sanitised cloud to one point a voxel and gives each a unit normal: the cloud's own where
// it has them, a viewpoint does not contradict and neighbours are turned to the same side; else
// estimated ones. `counts` comes from sanitise. Throws Error{kInvalidArgument} when fewer than 4
// points are left, or all lie on one line.
PreparedCloud prepare_cloud(const PointCloud& cloud,
                            const CloudCounts& counts,
                            const PrepareOptions& options,
                            const RunContext& context);

}  // namespace landmarkdb
