#pragma once

#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Fills `cloud.normals` by plane fits to the neighbours within `radius_m` (at least 5 of them, else
// the 5 nearest), turned towards each point's viewpoint. Where no viewpoint is known they are
// turned consistently instead (see orient_consistently). Returns true when viewpoints decided. A
// point without a defined plane (collinear neighbours) gets the direction towards its viewpoint, or
// +z. `index` is over `cloud.points`. The same for any number of threads. Throws
// Error{kInvalidArgument} for a radius that is not positive and finite, and what context.check
// throws.
bool estimate_normals(PointCloud& cloud,
                      double radius_m,
                      const SpatialIndex& index,
                      const RunContext& context);

}  // namespace landmarkdb
