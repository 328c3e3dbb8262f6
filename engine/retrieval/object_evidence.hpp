#pragma once

#include "engine/retrieval/assess.hpp"

namespace landmarkdb {

// Measures how well the object's surface that must be seen under `assessed.T_entry_sensor` (it
// faces a viewpoint, and nothing was measured before it) lies on the query's, and how its whole
// surface agrees with what the sensor saw and saw through. Fills `assessed.evidence` but for
// observability and `outgrown`, and `assessed.score`.
void look_at_object(const Meeting& meeting,
                    const Entry& entry,
                    const CleanQuery& query,
                    Assessed& assessed);

// Evidence::outgrown: where the query's surface goes on in the object's own plane beyond its edge.
// An object that fits into a larger one has all its points on the surface; this is what tells. A
// model that is an open surface ends where its scan did, and is not held to it: 0 where the normals
// do not close.
double outgrown_share(const Meeting& meeting,
                      const Entry& entry,
                      const Eigen::Isometry3d& T_entry_sensor);

}  // namespace landmarkdb
