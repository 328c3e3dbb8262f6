#pragma once

#include <string>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb::testing {

// Writes the z of an organised cloud as a 16-bit grey PNG, `depth_scale` units a metre; invalid
// pixels are 0.
void write_depth_png(const std::string& path, const PointCloud& cloud, double depth_scale);

}  // namespace landmarkdb::testing
