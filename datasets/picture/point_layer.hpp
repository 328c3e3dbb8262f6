#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "datasets/picture/canvas.hpp"

namespace landmarkdb::datasets {

// A point as a view sees it: pixels from the left and from the top of the layer, and metres towards
// the viewer.
struct ViewPoint {
  Eigen::Vector2f px;
  float nearness_m = 0.0F;
};

struct PointStyle {
  float radius_px = 1.0F;
  Colour far, near;  // from the furthest to the nearest point
  float far_m = 0.0F, near_m = 1.0F;
  float shading = 1.0F;  // of edges against what lies behind; 0: flat
  float alpha = 1.0F;
  bool close_gaps = false;  // between points up to 16 pixels apart
};

// Draws points as small discs, the nearest on top, edges smoothed, with the shading of depth steps
// that tells one surface from the next (eye-dome lighting, Boucheny 2009). The layer's top left
// corner is at (x0, y0) of the canvas; nothing is drawn outside it.
void draw_points(Canvas& canvas,
                 int x0,
                 int y0,
                 int width,
                 int height,
                 std::span<const ViewPoint> points,
                 const PointStyle& style);

}  // namespace landmarkdb::datasets
