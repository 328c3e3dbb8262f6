#include "engine/mono/derive_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "engine/mono/model_faces.hpp"
#include "engine/mono/model_symmetry.hpp"
#include "engine/mono/orient_faces.hpp"
#include "engine/mono/visibility.hpp"
#include "engine/types/feature_names.hpp"

namespace landmarkdb {
namespace {

constexpr double kSamePlace = 1e-6;      // of the diameter: rounding in files of six digits
constexpr double kFlatFace = 1e-2;       // of the diameter: a face is called bent past it
constexpr double kBentFace = 5e-2;       // ... and refused past this
constexpr double kOnLine = 1e-3;         // of the diameter: points no further off are on one line
constexpr double kLeastFaceArea = 1e-8;  // of the squared diameter
// Sizes that a camera on a robot looks at; past them the units are probably others.
constexpr double kSmallest_m = 2e-3;
constexpr double kLargest_m = 50.0;

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g mm", metres * 1e3);
  return text;
}

double extent_of(const MonoModel& model) {
  double largest = 0.0;
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    for (std::size_t j = i + 1; j < model.points.size(); ++j) {
      largest = std::max(largest, (model.points[i].xyz - model.points[j].xyz).norm());
    }
  }
  for (std::size_t i = 0; i < model.circles.size(); ++i) {
    largest = std::max(largest, 2.0 * model.circles[i].radius_m);
    for (std::size_t j = i + 1; j < model.circles.size(); ++j) {
      largest = std::max(largest, (model.circles[i].center - model.circles[j].center).norm());
    }
  }
  return largest;
}

class Deriver {
 public:
  Deriver(const Input& input, ModelDraft& draft)
      : input_(input), draft_(draft), model_(draft.model) {}

  void run(const RunContext& context) {
    require_limits();
    model_.diameter_m = extent_of(model_);
    if (!(model_.diameter_m > 0.0)) {
      refuse(input_, "has no extent: want three points at different places, or a circle");
    }
    merge_points();
    check_faces();
    orient();
    make_edges();
    add_circle_centres();
    add_face_centres();
    require_limits();
    model_.diameter_m = extent_of(model_);
    turn_circles();
    set_normals();
    require_enough();
    context.check("model");
    make_symmetries(context);
    if (model_.diameter_m < kSmallest_m || model_.diameter_m > kLargest_m) {
      warn("is " + millimetres(model_.diameter_m) + " across: check its units");
    }
  }

 private:
  void warn(const std::string& sentence) { draft_.warnings.push_back(sentence); }

  void require_limits() const {
    require_at_most(input_, model_.points.size(), kMaxModelPoints, "points");
    require_at_most(input_, model_.edges.size(), 2 * kMaxModelEdges, "edges");
    require_at_most(input_, model_.faces.size(), kMaxModelFaces, "faces");
    require_at_most(input_, model_.circles.size(), kMaxModelCircles, "circles");
  }

  bool same_place(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return (a - b).norm() <= kSamePlace * model_.diameter_m;
  }

  void merge_points() {
    std::vector<std::uint32_t> moved(model_.points.size());
    std::vector<ModelFeature> kept;
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
      const ModelFeature& p = model_.points[i];
      const auto twin = std::find_if(kept.begin(), kept.end(), [&](const ModelFeature& q) {
        return q.type == p.type && same_place(p.xyz, q.xyz);
      });
      moved[i] = static_cast<std::uint32_t>(twin - kept.begin());
      if (twin == kept.end()) kept.push_back(p);
    }
    const std::size_t lost = model_.points.size() - kept.size();
    if (lost == 0) return;
    for (std::uint32_t i = 0; i < moved.size(); ++i) {
      const bool first = std::find(moved.begin(), moved.end(), moved[i]) == moved.begin() + i;
      if (first) continue;
      warn("point " + std::to_string(i) + " lies where an earlier one does: they are one (" +
           std::to_string(lost) + " in all); later points moved up");
      break;
    }
    model_.points = std::move(kept);
    for (auto& [a, b] : model_.edges) {
      a = moved[a];
      b = moved[b];
    }
    std::erase_if(model_.edges, [](const auto& edge) { return edge[0] == edge[1]; });
    for (auto& face : model_.faces) {
      for (std::uint32_t& corner : face) corner = moved[corner];
    }
  }

  void check_faces() {
    for (std::size_t f = 0; f < model_.faces.size(); ++f) {
      std::vector<std::uint32_t>& face = model_.faces[f];
      const std::string what = "face " + std::to_string(f);
      face.erase(std::unique(face.begin(), face.end()), face.end());
      while (face.size() > 1 && face.front() == face.back()) face.pop_back();
      if (std::set<std::uint32_t>(face.begin(), face.end()).size() < 3) {
        refuse(input_, what + " has fewer than 3 different points");
      }
      const double squared = model_.diameter_m * model_.diameter_m;
      if (!(area_vector(model_, face).norm() > kLeastFaceArea * squared)) {
        refuse(input_, what + " has no area: its points lie on one line");
      }
      const double bent_m = out_of_plane_m(model_, face);
      if (bent_m > kBentFace * model_.diameter_m) {
        refuse(input_,
               what + " is no plane: a point lies " + millimetres(bent_m) +
                   " off it; split it into flat faces");
      }
      if (bent_m > kFlatFace * model_.diameter_m) {
        warn(what + " is bent: a point lies " + millimetres(bent_m) + " off its plane");
      }
    }
  }

  void orient() {
    const OrientResult result = orient_faces(model_);
    if (!result.crowded.empty()) {
      warn("side " + result.crowded.front() + " belongs to more than two faces" +
           (result.crowded.size() > 1
                ? ", as do " + std::to_string(result.crowded.size() - 1) + " others"
                : std::string()) +
           ": what they bound is no solid, its faces are seen from both sides");
    } else if (result.open && !is_flat(model_)) {
      warn("its faces are not closed: those of the open part are seen from both sides");
    }
    if (result.turned > 0) {
      warn(std::to_string(result.turned) + " of " + std::to_string(model_.faces.size()) +
           " faces were wound inward and were turned outward");
    }
  }

  // A side that one face uses twice is the bridge to a hole in it, and no edge.
  void make_edges() {
    std::set<std::array<std::uint32_t, 2>> edges;
    if (draft_.edges_listed) {
      for (const auto& [a, b] : model_.edges) edges.insert({std::min(a, b), std::max(a, b)});
    } else {
      for (const auto& face : model_.faces) {
        std::map<std::array<std::uint32_t, 2>, int> uses;
        for (std::size_t i = 0; i < face.size(); ++i) {
          const std::uint32_t a = face[i];
          const std::uint32_t b = face[(i + 1) % face.size()];
          ++uses[{std::min(a, b), std::max(a, b)}];
        }
        for (const auto& [edge, count] : uses) {
          if (count == 1) edges.insert(edge);
        }
      }
    }
    require_at_most(input_, edges.size(), kMaxModelEdges, "edges");
    model_.edges.assign(edges.begin(), edges.end());
  }

  // The point of this type at this place, added behind the others where there is none.
  ModelFeature& point_at(FeatureType type, const Eigen::Vector3d& xyz) {
    for (ModelFeature& p : model_.points) {
      if (p.type == type && same_place(p.xyz, xyz)) return p;
    }
    model_.points.push_back({type, xyz});
    return model_.points.back();
  }

  void add_circle_centres() {
    for (std::size_t c = 0; c < model_.circles.size(); ++c) {
      ModelFeature& centre = point_at(FeatureType::kConicCentre, model_.circles[c].center);
      if (centre.part < 0) centre.part = static_cast<std::int32_t>(c);
    }
  }

  void add_face_centres() {
    const bool listed =
        std::any_of(model_.points.begin(), model_.points.end(), [](const ModelFeature& p) {
          return p.type == FeatureType::kCentroid;
        });
    if (!listed && model_.points.size() + model_.faces.size() > kMaxModelPoints) {
      warn("its " + std::to_string(model_.faces.size()) +
           " faces got no centroids: there would be over " + std::to_string(kMaxModelPoints) +
           " points");
      return;
    }
    for (std::size_t f = 0; f < model_.faces.size(); ++f) {
      const Eigen::Vector3d middle = area_centroid(model_, model_.faces[f]);
      for (ModelFeature& p : model_.points) {
        const bool here = p.type == FeatureType::kCentroid && p.part < 0 &&
                          (p.xyz - middle).norm() <= kOnLine * model_.diameter_m;
        if (here) p.part = static_cast<std::int32_t>(f);
      }
      if (listed) continue;
      ModelFeature& centre = point_at(FeatureType::kCentroid, middle);
      if (centre.part < 0) centre.part = static_cast<std::int32_t>(f);
    }
  }

  // A circle drawn on a solid's face looks where the face does.
  void turn_circles() {
    const std::vector<bool> solid = solid_faces(model_);
    std::size_t turned = 0;
    for (ModelCircle& circle : model_.circles) {
      for (std::size_t f = 0; f < model_.faces.size(); ++f) {
        const Eigen::Vector3d normal = area_vector(model_, model_.faces[f]).normalized();
        const Eigen::Vector3d& corner = model_.points[model_.faces[f].front()].xyz;
        const bool on_face =
            std::abs(normal.dot(circle.center - corner)) <= kOnLine * model_.diameter_m &&
            normal.dot(circle.normal) < -1.0 + kOnLine;
        if (!solid[f] || !on_face) continue;
        circle.normal = -circle.normal;
        ++turned;
        break;
      }
    }
    if (turned > 0) warn(std::to_string(turned) + " circles looked inward and were turned outward");
  }

  void set_normals() {
    if (is_flat(model_)) return;
    const std::vector<bool> solid = solid_faces(model_);
    for (ModelFeature& p : model_.points) {
      if (p.part < 0 || p.normal) continue;
      const auto part = static_cast<std::size_t>(p.part);
      if (p.type == FeatureType::kConicCentre) p.normal = model_.circles[part].normal;
      if (p.type == FeatureType::kCentroid && solid[part]) {
        p.normal = area_vector(model_, model_.faces[part]).normalized();
      }
    }
  }

  bool on_one_line() const {
    const Eigen::Vector3d& origin = model_.points.front().xyz;
    Eigen::Vector3d far = Eigen::Vector3d::Zero();
    for (const ModelFeature& p : model_.points) {
      if ((p.xyz - origin).norm() > far.norm()) far = p.xyz - origin;
    }
    return std::all_of(model_.points.begin(), model_.points.end(), [&](const ModelFeature& p) {
      return far.cross(p.xyz - origin).norm() <= kOnLine * model_.diameter_m * far.norm();
    });
  }

  void require_enough() {
    const std::size_t count = model_.points.size();
    if (model_.circles.empty() && count < 3) {
      refuse(input_, "has " + std::to_string(count) + " points, want at least 3 or a circle");
    }
    const bool line = on_one_line();
    if (line && model_.circles.empty()) {
      refuse(input_, "has all its points on one line, want three that are not");
    }
    if (line) {
      warn("its points lie on one line: they alone do not tell its pose");
    } else if (count < 4) {
      warn("has " + std::to_string(count) +
           " points: it is stored, but four or more are needed to recognise it");
    }
  }

  void make_symmetries(const RunContext& context) {
    std::vector<Eigen::Matrix4d> listed = std::move(model_.symmetries);
    model_.symmetries = {Eigen::Matrix4d::Identity()};
    if (!draft_.symmetries_listed) {
      model_.symmetries = derive_symmetries(model_, context);
    }
    constexpr double kSame = 1e-6;
    for (std::size_t i = 0; i < listed.size(); ++i) {
      const bool known = std::any_of(
          model_.symmetries.begin(), model_.symmetries.end(), [&](const Eigen::Matrix4d& T) {
            return (T - listed[i]).cwiseAbs().maxCoeff() < kSame;
          });
      if (known) continue;
      const double error_m = symmetry_error_m(model_, listed[i]);
      if (error_m > kOnLine * model_.diameter_m) {
        warn("symmetry " + std::to_string(i) + " does not map the points onto themselves (" +
             millimetres(error_m) + " off); it is kept as listed");
      }
      model_.symmetries.push_back(listed[i]);
    }
    model_.symmetry_class = symmetry_class(model_);
  }

  const Input& input_;
  ModelDraft& draft_;
  MonoModel& model_;
};

}  // namespace

void derive_model(const Input& input, ModelDraft& draft, const RunContext& context) {
  Deriver(input, draft).run(context);
}

}  // namespace landmarkdb
