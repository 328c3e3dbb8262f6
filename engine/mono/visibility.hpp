#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// The directions of the 256 views, unit, from the object towards the camera: a Fibonacci sphere
// (golden angle, equal steps of z), the same in every process.
const std::array<Eigen::Vector3d, kModelViews>& model_views();

// True where each side of each face belongs to exactly one other face of the same connected part,
// one value a face: such a part is a solid and its faces are seen from outside only. The faces of
// an open part are sheets, seen from both sides.
std::vector<bool> solid_faces(const MonoModel& model);

// True when all points lie in one plane, within a thousandth of the diameter.
bool is_flat(const MonoModel& model);

// Which of a model's points a camera sees. Built once a model; const methods are thread-safe.
//
// A point is seen when its normal, if it has one, is turned at most 101 degrees away from the
// camera (n.view > -0.2, as contours are seen a little past the horizon), when it is the centre of
// a solid's face and that face is turned to the camera, when at least one face around it is turned
// to the camera if all of them are a solid's, and when no face lies between. Nothing else hides: a
// circle is a line.
class ModelVisibility {
 public:
  explicit ModelVisibility(const MonoModel& model);

  // From far away in `direction` (unit, from the object towards the camera), and from the camera
  // centre `eye` (metres, object frame); one value a point.
  std::vector<bool> points_along(const Eigen::Vector3d& direction) const;
  std::vector<bool> points_from(const Eigen::Vector3d& eye) const;

  // Whether a face is turned to a camera at `eye`; a sheet always is.
  bool face_turned_to(std::size_t face, const Eigen::Vector3d& eye) const;

  // Whether no face lies between `place` (metres, object frame) and the camera centre.
  bool place_seen_from(const Eigen::Vector3d& place, const Eigen::Vector3d& eye) const;

  std::size_t point_count() const { return points_.size(); }

 private:
  friend class PlaceSight;
  struct Face {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset_m = 0.0;                   // normal . x of its plane
    std::array<int, 2> axes{0, 1};           // what is left when the normal's largest is dropped
    std::vector<Eigen::Vector2d> outline{};  // in these axes
    bool solid = false;
  };

  bool seen(std::size_t point, const Eigen::Vector3d& direction, double distance_m) const;
  bool hidden(const Eigen::Vector3d& place,
              const Eigen::Vector3d& direction,
              double distance_m,
              const std::vector<std::uint32_t>* around) const;

  std::vector<ModelFeature> points_{};
  std::vector<Face> faces_{};
  std::vector<std::vector<std::uint32_t>> faces_of_{};  // a point's
  double clearance_m_ = 0.0;                            // nearer than this nothing hides
  bool convex_ = false;                                 // solid, no point before any of its faces
};

// Which places of a model one camera sees: what ModelVisibility::place_seen_from says, for many
// places from the same camera centre (outside the model), some ten times as fast. Faces that are
// turned away hide nothing that others do not; of a convex body a place on a face that is turned to
// the camera is seen, whatever the other faces. The model's visibility must outlive it.
class PlaceSight {
 public:
  PlaceSight(const ModelVisibility& model, const Eigen::Vector3d& eye);

  bool sees(const Eigen::Vector3d& place) const;

 private:
  const ModelVisibility& model_;
  Eigen::Vector3d eye_;
  std::vector<std::uint32_t> hiding_;  // faces that may lie between
  std::vector<std::uint32_t> away_;    // of a convex body: the others
};

// Of each point, which of model_views() see it. Reports the views as progress of `stage`.
std::vector<ViewMask> views_of_points(const MonoModel& model,
                                      std::string_view stage,
                                      const RunContext& context);

}  // namespace landmarkdb
