#pragma once

#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Drops every point that is not finite, repeats an earlier position exactly, or lies so far from
// the bulk (beyond 1e5 times the bulk's own extent, at least 1e6 m) that no scan can have made it;
// the order of the rest is kept, the cloud is no longer organised. Normals that are not finite or
// not of unit length within 10 % are all dropped (the estimator makes new ones). Returns what was
// counted.
CloudCounts sanitise(PointCloud& cloud);

}  // namespace landmarkdb
