#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

#include "engine/geometry/camera.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Reads a 16-bit grey PNG whose values are distances along the camera's axis times
// `camera.depth_scale`, as an organised cloud in the camera's frame (z forward, x right, y down;
// the viewpoint is zero). Lens distortion is undone. Pixels without a depth (0, or 65535, which
// some drivers write) and pixels that the lens model cannot be inverted at are NaN.
//
// Throws Error{kInvalidArgument} for what is no such PNG, a size that is not the camera's, or a
// camera without a depth scale.
PointCloud read_depth_image(const std::filesystem::path& path, const Camera& camera);

// The same for a file that is in memory.
PointCloud parse_depth_image(std::span<const std::byte> bytes,
                             std::string_view name,
                             const Camera& camera);

}  // namespace landmarkdb
