#pragma once

#include <cstddef>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Drops the points that have no other within `radius_m`, and returns how many: a scanner's beam
// that straddles an edge reports a range between, and the point hangs in the air where a robot's
// sensor looks through. Where more than a fiftieth of the points stand alone the cloud is sparse,
// and all stay. The rest keeps its order. Throws what `context.check` does.
std::size_t drop_strays(PointCloud& cloud, double radius_m, const RunContext& context);

}  // namespace landmarkdb
