#include "engine/mono/model_triples.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

using Points = std::array<std::uint32_t, 3>;

class TripleMaker {
 public:
  explicit TripleMaker(const MonoModel& model) : model_(model), neighbours_(model.points.size()) {
    for (const auto& [a, b] : model.edges) {
      neighbours_[a].insert(b);
      neighbours_[b].insert(a);
    }
    for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
      corners_.emplace_back(model.faces[f].begin(), model.faces[f].end());
    }
  }

  std::vector<ModelTriple> make(const RunContext& context) {
    const std::vector<ViewMask> views = views_of_points(model_, "triples", context);
    for (std::uint32_t i = 0; i < neighbours_.size(); ++i) add_junction(i);
    for (std::uint32_t f = 0; f < corners_.size(); ++f) {
      context.check("triples");
      add_face(f);
    }
    std::vector<ModelTriple> made;
    for (const auto& [points, face] : wanted_) {
      ModelTriple triple;
      triple.points = points;
      triple.face = face;
      if (!make_triple(model_, triple)) continue;
      triple.links =
          static_cast<std::uint8_t>(linked(points[0], points[1]) + linked(points[0], points[2]) +
                                    linked(points[1], points[2]));
      triple.views = views[points[0]] & views[points[1]] & views[points[2]];
      made.push_back(triple);
    }
    return made;
  }

 private:
  int linked(std::uint32_t a, std::uint32_t b) const { return neighbours_[a].contains(b) ? 1 : 0; }

  // The lowest face that has all three among its corners; -1: none.
  std::int32_t face_of(const Points& points) const {
    for (std::size_t f = 0; f < corners_.size(); ++f) {
      const bool all = std::all_of(
          points.begin(), points.end(), [&](std::uint32_t p) { return corners_[f].contains(p); });
      if (all) return static_cast<std::int32_t>(f);
    }
    return -1;
  }

  void add(const Points& points, std::int32_t face) {
    if (wanted_.size() < kMaxModelTriples) wanted_.emplace(points, face);
  }

  void add_junction(std::uint32_t i) {
    const std::vector<std::uint32_t> ends(neighbours_[i].begin(), neighbours_[i].end());
    for (std::size_t a = 0; a < ends.size(); ++a) {
      for (std::size_t b = a + 1; b < ends.size(); ++b) {
        const Points points{i, ends[a], ends[b]};
        add(points, face_of(points));
      }
    }
  }

  void add_face(std::uint32_t f) {
    const std::vector<std::uint32_t> corners(corners_[f].begin(), corners_[f].end());
    for (std::size_t a = 0; a < corners.size(); ++a) {
      for (std::size_t b = a + 1; b < corners.size(); ++b) {
        for (std::size_t c = b + 1; c < corners.size(); ++c) {
          if (!known(corners[a], corners[b], corners[c])) {
            add({corners[a], corners[b], corners[c]}, static_cast<std::int32_t>(f));
          }
        }
      }
    }
  }

  // Whether these three stand already, with any of them as the junction.
  bool known(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return wanted_.contains({a, b, c}) || wanted_.contains({b, a, c}) ||
           wanted_.contains({c, a, b});
  }

  const MonoModel& model_;
  std::vector<std::set<std::uint32_t>> neighbours_;
  std::vector<std::set<std::uint32_t>> corners_{};
  std::map<Points, std::int32_t> wanted_{};
};

}  // namespace

bool make_triple(const MonoModel& model, ModelTriple& triple) {
  const auto& [i0, i1, i2] = triple.points;
  const Eigen::Vector3d& p0 = model.points[i0].xyz;
  const Eigen::Vector3d e1 = model.points[i1].xyz - p0;
  const Eigen::Vector3d e2 = model.points[i2].xyz - p0;
  triple.type_signature = static_cast<std::uint32_t>(model.points[i0].type) |
                          static_cast<std::uint32_t>(model.points[i1].type) << 2U |
                          static_cast<std::uint32_t>(model.points[i2].type) << 4U;
  triple.lengths_m = {e1.norm(), e2.norm(), (e2 - e1).norm()};
  const auto& l = triple.lengths_m;
  const double longest = std::max({l[0], l[1], l[2]});
  const Eigen::Vector3d normal = e1.cross(e2);
  // Not >=: two points at one place give 0 < 0.
  if (!(normal.norm() > kCollinearTriple * longest * longest)) return false;
  triple.u = e1 / l[0];
  triple.n = normal.normalized();
  triple.v = triple.n.cross(triple.u);
  triple.centroid = p0 + (e1 + e2) / 3.0;
  // [[a, b], [0, d]]^-1 = [[1/a, -b/(a d)], [0, 1/d]]
  const double a = l[0];
  const double b = e2.dot(triple.u);
  const double d = e2.dot(triple.v);
  triple.inverse = {1.0 / a, -b / (a * d), 1.0 / d};
  const double area = normal.norm();
  triple.min_sin = std::min({area / (l[0] * l[1]), area / (l[0] * l[2]), area / (l[1] * l[2])});
  return true;
}

std::vector<ModelTriple> make_triples(const MonoModel& model, const RunContext& context) {
  return TripleMaker(model).make(context);
}

}  // namespace landmarkdb
