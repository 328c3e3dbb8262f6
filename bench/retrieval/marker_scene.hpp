#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/place.hpp"
#include "engine/geometry/camera.hpp"

namespace landmarkdb::bench {

// A printed square marker, as a grid of cells, rows from the top; 0 black, 255 white.
struct MarkerPattern {
  int cells = 0;         // along an edge, white margin and all
  int border_cells = 0;  // along the edge that the size of a marker is told by
  std::vector<std::uint8_t> values;
};

// Eight bits of grey, row by row.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

// Where a marker of `size_m` (its black edge) may stand 2 to 4 m in front of the camera: within the
// middle of the image, tilted by up to 35 degrees, nothing between. T_camera_marker, the marker's
// frame x right, y down, z away from who looks at it. Nothing when the view is too narrow for it.
std::optional<Eigen::Isometry3d> place_marker(const datasets::Place& place,
                                              const Eigen::Isometry3d& T_scene_camera,
                                              const Camera& camera,
                                              double size_m,
                                              std::uint64_t seed);

// What a grey camera at the depth camera's place sees of the building and the marker in it: flat
// shades, one an object, 16 samples a pixel on the marker, then a blur of 0.8 pixels and noise of 2
// grey levels. The same for the same seed.
GreyImage render_grey(const datasets::Place& place,
                      const Eigen::Isometry3d& T_scene_camera,
                      const Camera& camera,
                      const MarkerPattern& pattern,
                      double size_m,
                      const Eigen::Isometry3d& T_camera_marker,
                      std::uint64_t seed);

}  // namespace landmarkdb::bench
