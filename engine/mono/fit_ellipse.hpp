#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// What the edge points are good for; their ratio decides how much the directions count.
struct EdgeNoise {
  double position_px = 0.3;
  double direction_rad = 0.05;
};

// An ellipse and how well its edge points determine it.
struct EllipseFit {
  ImageEllipse ellipse;          // rms_px is filled in, arc_rad is not
  double center_sigma_px = 0.0;  // one sigma of the worse direction, for the noise given
};

// The ellipse nearest to edge points, by positions and directions: the conic whose distances and
// angles to them, to first order, are smallest, then a step of Gauss-Newton on the same.
//
// Rows v and d of a point (x, y) with unit tangent (tx, ty), th = (A, B, C, D, E, F):
// v = (y^2, xy, x^2, y, x, 1), d = (2 y ty, x ty + y tx, 2 x tx, ty, tx, 0); minimises
// th^T S th / th^T T th with S = sum(v v^T / sp^2 + d d^T / sa^2), T = sum(gx gx^T + gy gy^T), the
// gradients of v, in coordinates of mean 0 and rms radius sqrt 2. Does not depend on where the
// image's origin is, unlike fits that fix D^2 + E^2.
//
// nullopt: fewer than 6 points, points on a line, or a conic that is no ellipse.
std::optional<EllipseFit> fit_ellipse(std::span<const EdgePoint> points, const EdgeNoise& noise);

// The coefficients A..F of an ellipse, as above, in pixels divided by `unit_px`; scaled to
// D^2 + E^2 = 1 with A > 0.
Eigen::Matrix<double, 6, 1> conic_of(const ImageEllipse& ellipse, double unit_px);

// The angle of the ellipse, as seen from its centre, that the points cover: 2 pi less the largest
// gap between neighbours.
double arc_of(const ImageEllipse& ellipse, std::span<const EdgePoint> points);

}  // namespace landmarkdb
