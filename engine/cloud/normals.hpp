#pragma once

#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Fills `cloud.normals` by plane fits to the neighbours within `radius_m` (at least 5 of them, else
// the 5 nearest), turned towards each point's viewpoint. Where no viewpoint is known they are
// turned consistently instead (propagated along a minimum spanning tree of the neighbour graph by
// normal agreement, Hoppe 1992; each connected part's sign is the one that points away from its
// inside, or towards the scene's centre for a part that encloses it). Returns true when viewpoints
// decided. A point without a defined plane (collinear neighbours) gets the direction towards its
// viewpoint, or +z.
bool estimate_normals(PointCloud& cloud,
                      double radius_m,
                      const SpatialIndex& index,
                      const RunContext& context);

}  // namespace landmarkdb
