#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// What is found in one image. Everything is in pixels of that image, pixel centres at whole
// numbers, lens distortion still in it.

// A point of an edge, to a fraction of a pixel; `normal` is the unit gradient (towards brighter).
struct EdgePoint {
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();
  Eigen::Vector2f normal = Eigen::Vector2f::UnitX();
};

// A straight piece of an edge chain, with its own direction: brighter on the left of from -> to.
struct ImageSegment {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double rms_px = 0.0;
};

// An elliptic piece of an edge chain.
struct ImageEllipse {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double major_px = 0.0, minor_px = 0.0;  // semi-axes
  double angle_rad = 0.0;                 // of the major axis, from +u towards +v
  double arc_rad = 0.0;                   // how much of it was seen
  double rms_px = 0.0;
};

// A point that may be some model's feature. `directions`: of the edges that meet in it, pointing
// away from it (radians, from +u towards +v); empty where they are not known.
struct ImageFeature {
  FeatureType type = FeatureType::kVertex;
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  std::vector<double> directions{};
  double sigma_px = 1.0;  // what its position is good for
};

struct ImageFeatures {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<ImageFeature> points{};
  std::vector<std::array<std::uint32_t, 2>> links{};  // pairs of points that one segment joins
  std::vector<ImageSegment> segments{};
  std::vector<ImageEllipse> ellipses{};
  std::vector<EdgePoint> edges{};  // empty where only points were given
};

}  // namespace landmarkdb
