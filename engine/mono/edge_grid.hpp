#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// The edge points of one image, by cells of a few pixels.
class EdgeGrid {
 public:
  explicit EdgeGrid(const ImageFeatures& features);

  bool empty() const { return edges_.empty(); }
  // Edge points a pixel of the image.
  double density() const { return density_; }

  // The edge point nearest to `uv` (pixels) along `normal` (unit), within `reach_px` of it and with
  // a gradient within the cosine of it, whichever side is the brighter. nullptr: none.
  const EdgePoint* nearest(const Eigen::Vector2d& uv,
                           const Eigen::Vector2d& normal,
                           double reach_px,
                           double min_cosine) const;

  // Calls visit(offset along the normal, cosine of the gradient to it) for all such edge points.
  template <typename Visit>
  void for_each_across(const Eigen::Vector2d& uv,
                       const Eigen::Vector2d& normal,
                       double reach_px,
                       double min_cosine,
                       const Visit& visit) const {
    const std::optional<Cells> cells = cells_near(uv, normal, reach_px);
    if (!cells) return;
    for (std::size_t y = cells->first_y; y <= cells->last_y; ++y) {
      for (const EdgePoint& edge : row_of(*cells, y)) {
        const Eigen::Vector2d d = edge.uv.cast<double>() - uv;
        const double along = d.dot(normal);
        if (std::abs(along) > reach_px ||
            std::abs(d.x() * normal.y() - d.y() * normal.x()) > kBeside_px) {
          continue;
        }
        const double cosine = edge.normal.cast<double>().dot(normal);
        if (std::abs(cosine) >= min_cosine) visit(along, cosine);
      }
    }
  }

 private:
  // Of the line along the normal: edge points stand a pixel apart.
  static constexpr double kBeside_px = 1.5;
  struct Cells {
    std::size_t first_x, last_x, first_y, last_y;
  };
  // Around the line across `uv` on which edge points are looked for.
  std::optional<Cells> cells_near(const Eigen::Vector2d& uv,
                                  const Eigen::Vector2d& normal,
                                  double reach_px) const;
  std::span<const EdgePoint> row_of(const Cells& cells, std::size_t y) const {
    const std::size_t row = y * columns_;
    return {edges_.data() + starts_[row + cells.first_x],
            edges_.data() + starts_[row + cells.last_x + 1]};
  }

  std::vector<EdgePoint> edges_;       // by cell
  std::vector<std::uint32_t> starts_;  // a cell's first
  std::size_t columns_ = 0, rows_ = 0;
  double density_ = 0.0;
};

// A place on a model's edge that a pose shows, in the image.
struct EdgeSample {
  Eigen::Vector3d xyz;     // metres, object frame
  Eigen::Vector2d uv;      // pixels
  Eigen::Vector2d normal;  // unit, across the edge in the image
  std::uint32_t line = 0;  // the model's edge; past the last one: a circle
};

// The visible part of a model's edges and circles at a pose, a sample every `step_px` of image, at
// most `most` in all. What lies outside the image (width x height) is left out.
std::vector<EdgeSample> visible_edges(const SearchModel& model,
                                      const Camera& camera,
                                      const RigidPose& pose,
                                      double step_px,
                                      std::size_t most);

// The share of samples with an image edge within 2 px and 20 degrees.
double edge_share(std::span<const EdgeSample> samples, const EdgeGrid& grid);

}  // namespace landmarkdb
