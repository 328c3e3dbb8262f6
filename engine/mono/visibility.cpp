#include "engine/mono/visibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "engine/mono/model_faces.hpp"

namespace landmarkdb {
namespace {

// n.view of a point with a normal at which it stops being seen: cyclope.md's choice for features
// that are contours (a circle's rim is seen a little past its horizon in perspective).
constexpr double kGrazing = -0.2;
// Of the diameter: models are measured to about this; see is_flat and clearance_m_.
constexpr double kTolerance = 1e-3;

using Side = std::pair<std::uint32_t, std::uint32_t>;

Side undirected(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

bool inside(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& p) {
  bool odd = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) odd = !odd;
  }
  return odd;
}

std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

const std::array<Eigen::Vector3d, kModelViews>& model_views() {
  static const std::array<Eigen::Vector3d, kModelViews> views = [] {
    std::array<Eigen::Vector3d, kModelViews> made;
    const double golden_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < kModelViews; ++i) {
      const double z =
          1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(kModelViews);
      const double radius = std::sqrt(1.0 - z * z);
      const double angle = golden_rad * static_cast<double>(i);
      made[i] = {radius * std::cos(angle), radius * std::sin(angle), z};
    }
    return made;
  }();
  return views;
}

std::vector<bool> solid_faces(const MonoModel& model) {
  std::vector<std::uint32_t> parents(model.faces.size());
  std::map<Side, std::vector<std::uint32_t>> users;
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    parents[f] = f;
    const auto& face = model.faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      users[undirected(face[i], face[(i + 1) % face.size()])].push_back(f);
    }
  }
  for (const auto& [side, faces] : users) {
    for (const std::uint32_t f : faces) parents[root_of(parents, f)] = root_of(parents, faces[0]);
  }
  std::vector<bool> open(model.faces.size(), false);  // by root
  for (const auto& [side, faces] : users) {
    // A face that uses a side twice has a bridge to a hole of its own there.
    const bool bridge = faces.size() == 2 && faces[0] == faces[1];
    if (!bridge && faces.size() != 2) open[root_of(parents, faces[0])] = true;
  }
  std::vector<bool> solid(model.faces.size());
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) solid[f] = !open[root_of(parents, f)];
  return solid;
}

bool is_flat(const MonoModel& model) {
  if (model.points.empty()) return true;
  // The normal of the largest triangle over the two points that are furthest apart.
  const Eigen::Vector3d& origin = model.points.front().xyz;
  Eigen::Vector3d far = Eigen::Vector3d::Zero();
  for (const ModelFeature& p : model.points) {
    if ((p.xyz - origin).norm() > far.norm()) far = p.xyz - origin;
  }
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const ModelFeature& p : model.points) {
    const Eigen::Vector3d cross = far.cross(p.xyz - origin);
    if (cross.norm() > normal.norm()) normal = cross;
  }
  if (normal.norm() <= kTolerance * far.squaredNorm()) return true;
  normal.normalize();
  return std::all_of(model.points.begin(), model.points.end(), [&](const ModelFeature& p) {
    return std::abs(normal.dot(p.xyz - origin)) <= kTolerance * far.norm();
  });
}

ModelVisibility::ModelVisibility(const MonoModel& model)
    : points_(model.points),
      faces_of_(model.points.size()),
      clearance_m_(kTolerance * model.diameter_m) {
  const std::vector<bool> solid = solid_faces(model);
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    Face face;
    face.normal = area_vector(model, model.faces[f]).normalized();
    face.solid = solid[f];
    face.offset_m = face.normal.dot(model.points[model.faces[f].front()].xyz);
    Eigen::Index dropped = 0;
    face.normal.cwiseAbs().maxCoeff(&dropped);
    face.axes = {static_cast<int>((dropped + 1) % 3), static_cast<int>((dropped + 2) % 3)};
    for (const std::uint32_t corner : model.faces[f]) {
      const Eigen::Vector3d& xyz = model.points[corner].xyz;
      face.outline.emplace_back(xyz[face.axes[0]], xyz[face.axes[1]]);
      std::vector<std::uint32_t>& faces = faces_of_[corner];
      if (faces.empty() || faces.back() != f) faces.push_back(f);
    }
    faces_.push_back(std::move(face));
  }
  convex_ = !faces_.empty() && std::all_of(faces_.begin(), faces_.end(), [&](const Face& face) {
    return face.solid && std::all_of(points_.begin(), points_.end(), [&](const ModelFeature& p) {
             return face.normal.dot(p.xyz) <= face.offset_m + clearance_m_;
           });
  });
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].type == FeatureType::kCentroid && points_[i].part >= 0) {
      faces_of_[i] = {static_cast<std::uint32_t>(points_[i].part)};
    }
  }
}

PlaceSight::PlaceSight(const ModelVisibility& model, const Eigen::Vector3d& eye)
    : model_(model), eye_(eye) {
  for (std::uint32_t f = 0; f < model.faces_.size(); ++f) {
    if (model.face_turned_to(f, eye)) {
      hiding_.push_back(f);
    } else if (model.convex_) {
      away_.push_back(f);
    }
  }
}

bool PlaceSight::sees(const Eigen::Vector3d& place) const {
  const auto on = [&](std::uint32_t f) {
    const ModelVisibility::Face& face = model_.faces_[f];
    return std::abs(face.normal.dot(place) - face.offset_m) <= model_.clearance_m_;
  };
  if (model_.convex_) {
    if (std::any_of(hiding_.begin(), hiding_.end(), on)) return true;
    if (std::any_of(away_.begin(), away_.end(), on)) return false;
  }
  const Eigen::Vector3d ray = eye_ - place;
  const double distance_m = ray.norm();
  if (!(distance_m > 0.0)) return false;
  const double nearest = model_.clearance_m_ / distance_m;
  for (const std::uint32_t f : hiding_) {
    const ModelVisibility::Face& face = model_.faces_[f];
    const double slope = face.normal.dot(ray), over = face.offset_m - face.normal.dot(place);
    // Between place and eye: over / slope in (nearest, 1).
    if (slope > 0.0 ? over <= nearest * slope || over >= slope
                    : over >= nearest * slope || over <= slope) {
      continue;
    }
    if (std::abs(slope) < 1e-9 * distance_m) continue;  // seen edge-on: hides nothing
    const Eigen::Vector3d hit = place + over / slope * ray;
    if (inside(face.outline, {hit[face.axes[0]], hit[face.axes[1]]})) return false;
  }
  return true;
}

bool ModelVisibility::hidden(const Eigen::Vector3d& place,
                             const Eigen::Vector3d& direction,
                             double distance_m,
                             const std::vector<std::uint32_t>* around) const {
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    const double slope = face.normal.dot(direction);
    if (std::abs(slope) < 1e-9) continue;  // seen edge-on: hides nothing
    const double s = (face.offset_m - face.normal.dot(place)) / slope;
    if (s <= clearance_m_ || s >= distance_m) continue;
    if (around != nullptr && std::find(around->begin(), around->end(), f) != around->end()) {
      continue;
    }
    const Eigen::Vector3d hit = place + s * direction;
    if (inside(face.outline, {hit[face.axes[0]], hit[face.axes[1]]})) return true;
  }
  return false;
}

bool ModelVisibility::seen(std::size_t point,
                           const Eigen::Vector3d& direction,
                           double distance_m) const {
  const ModelFeature& feature = points_[point];
  if (feature.normal && feature.normal->dot(direction) <= kGrazing) return false;
  const std::vector<std::uint32_t>& around = faces_of_[point];
  const bool turned =
      around.empty() || std::any_of(around.begin(), around.end(), [&](std::uint32_t f) {
        return !faces_[f].solid || faces_[f].normal.dot(direction) > 0.0;
      });
  return turned && !hidden(feature.xyz, direction, distance_m, &around);
}

std::vector<bool> ModelVisibility::points_along(const Eigen::Vector3d& direction) const {
  std::vector<bool> result(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    result[i] = seen(i, direction, std::numeric_limits<double>::infinity());
  }
  return result;
}

std::vector<bool> ModelVisibility::points_from(const Eigen::Vector3d& eye) const {
  std::vector<bool> result(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d ray = eye - points_[i].xyz;
    const double distance_m = ray.norm();
    result[i] = distance_m > 0.0 && seen(i, ray / distance_m, distance_m);
  }
  return result;
}

std::vector<ViewMask> views_of_points(const MonoModel& model,
                                      std::string_view stage,
                                      const RunContext& context) {
  const ModelVisibility visibility(model);
  std::vector<ViewMask> masks(model.points.size());
  for (std::size_t view = 0; view < kModelViews; ++view) {
    context.report(stage, view, kModelViews);
    const std::vector<bool> seen = visibility.points_along(model_views()[view]);
    for (std::size_t i = 0; i < seen.size(); ++i) masks[i].set(view, seen[i]);
  }
  return masks;
}

bool ModelVisibility::face_turned_to(std::size_t face, const Eigen::Vector3d& eye) const {
  return !faces_[face].solid || faces_[face].normal.dot(eye) > faces_[face].offset_m;
}

bool ModelVisibility::place_seen_from(const Eigen::Vector3d& place,
                                      const Eigen::Vector3d& eye) const {
  const Eigen::Vector3d ray = eye - place;
  const double distance_m = ray.norm();
  return distance_m > 0.0 && !hidden(place, ray / distance_m, distance_m, nullptr);
}

}  // namespace landmarkdb
