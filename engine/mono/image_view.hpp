#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"

namespace landmarkdb {

// The feature points of one image as the search sees them: without lens distortion, in ideal pixels
// (ray times focal length, the principal point at zero), with a table of the nearest feature of
// each type.
//
// Points outside the lens model are left out and counted.
class ImageView {
 public:
  // `reach_px`: how far from a feature the table still answers. Throws Error{kInvalidArgument} for
  // a coordinate that is not finite or a link that points outside the array.
  ImageView(const ImageFeatures& features, const Camera& camera, double reach_px);

  struct Point {
    Eigen::Vector2d xy;    // ideal pixels
    Eigen::Vector2d uv;    // the image's
    std::uint32_t source;  // index into the features' points
    std::uint8_t type;
    double sigma_px;
    std::vector<std::uint16_t> links{};  // ascending, by index here
    std::vector<double> directions{};    // of edges, away from it, in ideal pixels
  };

  std::size_t size() const { return points_.size(); }
  const Point& operator[](std::size_t i) const { return points_[i]; }
  const std::vector<Point>& points() const { return points_; }
  bool linked(std::size_t a, std::size_t b) const;
  std::size_t link_count() const { return links_; }
  std::size_t left_out() const { return left_out_; }
  double focal_px() const { return focal_px_; }

  // The nearest feature of a type within the reach (to a cell's width), or -1. A look-up.
  int nearest(std::uint8_t type, const Eigen::Vector2d& xy) const {
    const double x = (xy.x() - low_.x()) * per_cell_, y = (xy.y() - low_.y()) * per_cell_;
    if (!(x >= 0.0) || !(y >= 0.0) || !(x < width_) || !(y < height_)) return -1;
    return int{tables_[type]
                      [static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)]} -
           1;
  }

 private:
  void fill_tables(double reach_px);

  std::vector<Point> points_;
  std::size_t links_ = 0;
  std::size_t left_out_ = 0;
  double focal_px_ = 1.0;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double per_cell_ = 0.5;  // cells a pixel
  double width_ = 0.0, height_ = 0.0;
  std::size_t columns_ = 0;
  std::array<std::vector<std::uint16_t>, kFeatureTypes> tables_;  // 1 + index; 0: none near
};

}  // namespace landmarkdb
