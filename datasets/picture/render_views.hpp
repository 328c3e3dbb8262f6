#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "datasets/picture/canvas.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::datasets {

enum class Layout { kBeside, kStacked };  // the side view right of the top view, or below it

struct ViewsOptions {
  int width_px = 1600;  // 400..8000; the height follows from the place
  Layout layout = Layout::kBeside;
  std::string title = {};             // "lobby-1: 4,097 points found ..."
  std::string place_label = "place";  // in the legend
  std::string query_label = "query";
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // scene frame
  // Draws the field of view of this camera; without one, only the sensor's axes.
  std::optional<Camera> frustum = {};
  double frustum_m = 3.0;  // how far it is drawn
};

// A plan of the place, its ceiling taken off, and a section seen from the side, both to one scale,
// with the query laid in by its pose: place in grey, query in orange, the sensor's axes in red (x),
// green (y) and blue (z). Walls lie along the picture's edges whatever the scene's own axes are.
// With an empty query only the place is drawn.
//
// Throws Error{kInvalidArgument} for a place without finite points or a width out of range.
Canvas render_views(const PointCloud& place,
                    const PointCloud& query,
                    const Eigen::Isometry3d& T_scene_sensor,
                    const ViewsOptions& options);

}  // namespace landmarkdb::datasets
