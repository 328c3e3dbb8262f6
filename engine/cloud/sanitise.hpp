#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Drops every point that is not finite, repeats an earlier position exactly, or lies so far from
// the bulk (beyond 3,000 times the bulk's own extent, at least 100 m) that no scan can have made
// it; the order of the rest is kept, the cloud is no longer organised. Normals are made exactly
// unit; the few that are not finite or not of unit length within 10 % take the nearest good one,
// and with more than a tenth of them bad all are dropped (the estimator makes new ones). Viewpoints
// that are not finite, or a point's number of one that is not there, drop the viewpoints. Returns
// what was counted. Throws Error{kInvalidArgument} when the arrays differ in length, and what
// `context.check` does; the cloud is then of no use.
CloudCounts sanitise(PointCloud& cloud, const RunContext& context = {});

}  // namespace landmarkdb
