#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/mono/pose_equations.hpp"
#include "engine/mono/search_tables.hpp"
#include "engine/mono/visibility.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// One model with everything that the search asks of it again and again.
struct SearchModel {
  std::shared_ptr<const MonoModelRecord> record;
  ModelVisibility visibility;
  std::vector<PosePoint> points;  // xyz, and radius and normal of a circle's centre
  std::vector<std::vector<std::uint32_t>> neighbours;  // of a point, along edges; ascending
  std::vector<char> joined;                            // n x n: whether an edge joins two points
  std::vector<std::vector<std::uint16_t>> seen;        // by view: the points seen from there
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_m = 0.0;                      // of a sphere around center that holds all points
  std::vector<ChosenQuad> quads;              // empty where they were left out
  std::vector<ViewMask> outline_seen;         // SearchTables
  std::vector<Eigen::Isometry3d> lookalikes;  // SearchTables

  const MonoModel& model() const { return record->model; }
  bool linked(std::uint32_t a, std::uint32_t b) const { return joined[a * points.size() + b] != 0; }
};

// A model's points as they are measured: the centre of a circle by that of its ellipse, the
// centroid of a face by the centre of gravity of its image.
std::vector<PosePoint> pose_points(const MonoModel& model);

// From the record's own index where it has one that fits, and else from a new one.
SearchTables tables_of(const MonoModelRecord& record,
                       const RunContext& context = {},
                       QuadUse quads = QuadUse::kWanted);

SearchModel prepare_model(std::shared_ptr<const MonoModelRecord> record,
                          const SearchTables& tables);
SearchModel prepare_model(std::shared_ptr<const MonoModelRecord> record);

// The number of the model view nearest to a direction (from the object to the camera, of any
// length), to a degree. A look-up.
std::size_t nearest_view(const Eigen::Vector3d& direction);

// Whether pose b is pose a but for one of the model's symmetries, within `angle_rad` and
// `distance_m` of the model's center.
bool same_but_for_symmetry(const SearchModel& model,
                           const RigidPose& a,
                           const RigidPose& b,
                           double angle_rad,
                           double distance_m);

// Rigid motions of a model that carry at least `share` of its points onto points of the same type
// and that are none of its symmetries; most points first, at most `most`.
std::vector<Eigen::Isometry3d> find_lookalikes(const MonoModel& model,
                                               double share,
                                               std::size_t most);

}  // namespace landmarkdb
