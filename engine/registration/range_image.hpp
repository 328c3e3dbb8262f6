#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/registration/sight_rays.hpp"
#include "engine/registration/sight_surface.hpp"

namespace landmarkdb {

// What the sensor should have measured under a pose, against what it did; counts of directions.
struct SightCounts {
  std::size_t measured = 0;  // directions the sensor measured, their neighbours too
  std::size_t agree = 0;     // the entry has a surface at the range measured
  std::size_t crossed = 0;   // the entry has a surface nearer: the ray went through it
  std::size_t hidden = 0;    // the entry has a surface further off only: something stands before it
  // In the remaining directions the entry has nothing (it was not scanned there) or only the back
  // of a surface further off (seen through a gap of its scan), and nothing is said.
  std::size_t predicted() const { return agree + crossed + hidden; }

  // Crossed or hidden by SightTolerance::solid of the tolerance, and the eight directions around
  // are none that agree as closely. A silhouette half a cell off leaves a line of contradictions;
  // something that is not there leaves an area.
  std::size_t solid = 0;
  std::size_t solid_crossed = 0;  // of these, those crossed

  SightCounts& operator+=(const SightCounts& other);
};

// The outline of a surface as the sensor should have seen it; counts of directions two cells beyond
// it.
struct OutlineCounts {
  std::size_t measured = 0;   // the sensor measured there
  std::size_t continued = 0;  // at the range of the outline: what is seen goes on beyond it
  OutlineCounts& operator+=(const OutlineCounts& other);
};

// How far before or behind the measured range still counts as seen: fixed, and a share of the
// range. What contradicts in an area need be off by no more than `solid` of that: noise is not off
// together.
struct SightTolerance {
  float metres = 0.0F;
  float share = 0.0F;
  float solid = 1.0F;
};

// The points of each of the viewpoints, in their order; without an index all are of the first.
std::vector<std::vector<Eigen::Vector3f>> points_by_viewpoint(
    std::span<const Eigen::Vector3f> points,
    std::size_t viewpoints,
    std::span<const std::uint16_t> viewpoint_index);

// The nearest and furthest range a cloud has in each direction from its viewpoint: free space as
// the sensor saw it. The sphere is cut into the six faces of a cube, each into cells of equal
// angle, so that no direction is a pole; directions never measured stay unknown. Works for a depth
// camera, a spinning laser and a fused fragment alike: the cells are widened until most of those
// measured have measured neighbours. Immutable, thread-safe.
class RangeImage {
 public:
  // `points` in metres, any frame; `viewpoint` in the same frame. `finest_step_rad` is the least
  // width of a cell.
  RangeImage(std::span<const Eigen::Vector3f> points,
             const Eigen::Vector3f& viewpoint,
             double finest_step_rad);

  // Renders `surface` (carried into this frame by T_here_surface, each point a patch `patch_m`
  // wide) and compares. Only directions whose eight neighbours were measured too are counted, so
  // that silhouettes decide nothing. Cost: one projection a point of the blocks in view.
  SightCounts compare(const SightSurface& surface,
                      const Eigen::Isometry3d& T_here_surface,
                      float patch_m,
                      const SightTolerance& tolerance) const;

  // Renders `surface` in the same way and looks beyond the outline of what agrees.
  OutlineCounts outline(const SightSurface& surface,
                        const Eigen::Isometry3d& T_here_surface,
                        float patch_m,
                        const SightTolerance& tolerance) const;

  // True when the sensor measured something nearer than `p` (its own frame) in that direction and
  // all around it, by more than `slack_m`: the point cannot have been seen.
  bool hides(const Eigen::Vector3f& p, float slack_m) const;

  // True when the sensor measured something further than `p` (its own frame) in that direction and
  // all around it, by more than `slack_m`: nothing is there.
  bool looked_through(const Eigen::Vector3f& p, float slack_m) const;

  std::size_t memory_bytes() const;
  float max_range_m() const { return max_range_m_; }
  double step_rad() const { return step_rad_; }

 private:
  struct Cell {
    float nearest, furthest;
  };
  struct Place {
    int face, row, column;
  };
  struct Predicted {
    float range;  // of the nearest surface; infinite: none
    bool back;    // it is seen from behind
  };
  // Cells of a face, the last among them; none at first.
  struct Box {
    int first_row = 1 << 30, last_row = -1;
    int first_column = 1 << 30, last_column = -1;
  };
  // What a surface should have shown: `predicted` has one for each of `inner_`, all of which but
  // those in the boxes are without a surface. An object fills a small part of a view.
  struct Rendered {
    std::vector<Predicted> predicted;
    std::array<Box, 6> boxes;  // of each face
  };
  // How far off a point is, and what was measured around its direction; furthest = 0: not all of it
  // was.
  struct Measured {
    float range;
    Cell wide;
  };
  Measured measured_at(const Eigen::Vector3f& p) const;
  // Whether anything of a block, its centre seen from the viewpoint, may lie in view.
  bool in_view(const Eigen::Vector3f& centre, float radius_m) const;
  Rendered render(const SightSurface& surface,
                  const Eigen::Isometry3d& T_here_surface,
                  float patch_m) const;
  // Half so many cells to each side of a place, where that is nearer than what was predicted.
  void lay_patch(const Place& place,
                 int half,
                 const Predicted& patch,
                 std::span<Predicted> predicted) const;
  // Those that hold all that was predicted.
  std::array<Box, 6> boxes_of(std::span<const Predicted> predicted) const;
  // Where most of the directions around are predicted, the surface is taken to go on between its
  // points: as far off as the furthest of those. Beyond a box there are three at most.
  void fill_gaps(Rendered& rendered) const;
  template <typename Visit>
  void visit_inner(const std::array<Box, 6>& boxes, const Visit& visit) const;
  template <typename Visit>
  void visit_around(const Place& place, const Visit& visit) const;
  void count_solid(const std::array<Box, 6>& boxes,
                   const std::vector<signed char>& says,
                   SightCounts& counts) const;
  // Cells that were measured, and of them those whose neighbours were too.
  struct Completeness {
    std::size_t measured = 0, complete = 0;
  };
  void choose_step(std::span<const Eigen::Vector3f> points);
  void measure(std::span<const Eigen::Vector3f> points);
  Completeness completeness() const;
  int cell_along(float tangent) const;
  Place place_of(const Eigen::Vector3f& ray) const;
  static Place place_of(const SightRay& ray);
  Place place_at(std::size_t cell) const;
  std::size_t index_of(const Place& place) const;
  Cell widen(std::size_t cell) const;
  void measure_cone(std::span<const Eigen::Vector3f> points);
  void number_inner();

  Eigen::Vector3f viewpoint_;
  double step_rad_ = 0.0;
  int side_ = 0;  // cells along an edge of a face
  float max_range_m_ = 0.0F;
  // Around all directions measured, and as far beyond them as a patch reaches: what a surface
  // shows outside of it is compared with nothing.
  Eigen::Vector3f cone_axis_ = Eigen::Vector3f::UnitZ();
  float cone_cosine_ = -1.0F;
  float cone_half_angle_rad_ = 0.0F;
  std::vector<Cell> cells_;
  // Over the 3 x 3 cells around; furthest = 0 where one of these is unknown.
  std::vector<Cell> widened_;
  // Those of the cells that are compared: all around them was measured. And the number among them
  // of each cell, kOuter where it is none of them.
  static constexpr std::uint32_t kOuter = ~std::uint32_t{0};
  std::vector<std::uint32_t> inner_;
  std::vector<std::uint32_t> inner_of_cell_;
};

}  // namespace landmarkdb
