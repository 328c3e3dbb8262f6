#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "bench/retrieval/marker_scene.hpp"

namespace landmarkdb::bench {

// The marker baseline: AprilTag 36h11, number 0, where libapriltag was there to build with.
// marker_name() is empty and the others have no answer where it was not.
std::string marker_name();
std::optional<MarkerPattern> marker_pattern();

// T_camera_marker of the marker in the image by AprilTag's own pose estimate; nothing where it is
// not seen.
std::optional<Eigen::Isometry3d> find_marker(const GreyImage& image,
                                             const Camera& camera,
                                             double size_m);

}  // namespace landmarkdb::bench
