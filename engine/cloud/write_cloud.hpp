#pragma once

#include <filesystem>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Writes a binary little-endian PLY (or, for a name that ends in .pcd, a binary PCD with width,
// height and viewpoint): x y z as float, or as double where the cloud has an origin; normals and
// colours where it has them. Viewpoints go into "comment viewpoint x y z" lines of the PLY header,
// several with a viewpoint number a point, and read_cloud reads them back; a PCD keeps a single
// one. Throws Error{kResourceExhausted} on a full disk,
// Error{kInvalidArgument} on a path that cannot be written.
void write_cloud(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace landmarkdb
