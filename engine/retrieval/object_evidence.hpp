#pragma once

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Measures how well the object's surface that must be seen under `assessed.T_entry_sensor` (it
// faces a viewpoint, and nothing was measured before it) lies on the query's, and how its whole
// surface agrees with what the sensor saw and saw through. Fills `assessed.evidence` but for
// what refinement and descriptors say, `outgrown` and `continued`, and `assessed.score`. Looks at
// about `most_points` of the object's points.
void look_at_object(const Meeting& meeting,
                    const Entry& entry,
                    const CleanQuery& query,
                    std::size_t most_points,
                    Assessed& assessed);

// Refines the pose with the points that must be seen alone: the others pair with what is not
// theirs.
void refine_seen(const Meeting& meeting, const CleanQuery& query, Assessed& assessed);

// Evidence::continued; 0 for an open surface, as with `outgrown`.
double continued_share(const Meeting& meeting,
                       const Entry& entry,
                       const Eigen::Isometry3d& T_entry_sensor);

// Evidence::confirmed: what the descriptors say of a pose, by the pairs that `matches` has.
double confirmed_share(const Meeting& meeting,
                       const Entry& entry,
                       const CleanQuery& query,
                       const EntryMatches& matches,
                       const Eigen::Isometry3d& T_entry_sensor);

// Evidence::outgrown: where the query's surface goes on in the object's own plane beyond its edge.
// An object that fits into a larger one has all its points on the surface; this is what tells. A
// model that is an open surface ends where its scan did, and is not held to it: 0 where the normals
// do not close.
double outgrown_share(const Meeting& meeting,
                      const Entry& entry,
                      const Eigen::Isometry3d& T_entry_sensor);

}  // namespace landmarkdb
