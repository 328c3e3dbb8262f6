#pragma once

#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// The clouds of one question as one, sanitised, in the frame they share; each point keeps the
// viewpoint it was seen from, and a cloud without one was seen from its own zero. `counts` says
// what was dropped, of all of them. Throws Error{kInvalidArgument} for none or for more than
// kMostQueryClouds, and what `context.check` does.
PointCloud join_clouds(std::vector<QueryCloud> clouds,
                       CloudCounts& counts,
                       const RunContext& context = {});

}  // namespace landmarkdb
