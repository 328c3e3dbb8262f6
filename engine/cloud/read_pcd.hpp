#pragma once

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// A PCD file in memory: ascii, binary or binary_compressed, organised or not. Throws
// Error{kInvalidArgument}.
PointCloud parse_pcd(const Input& input, const ReadOptions& options);

}  // namespace landmarkdb
