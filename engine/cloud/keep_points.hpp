#pragma once

#include <cstdint>
#include <vector>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Leaves these points of the cloud, with all that each has, in their order. `kept` ascends. The
// rows and columns of an organised cloud are left as they are.
void keep_points(PointCloud& cloud, const std::vector<std::uint32_t>& kept);

}  // namespace landmarkdb
