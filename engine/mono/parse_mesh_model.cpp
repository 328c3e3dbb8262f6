#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/cloud/read_mesh.hpp"
#include "engine/mono/mesh_regions.hpp"
#include "engine/mono/model_draft.hpp"

namespace landmarkdb {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kStraight_rad = 1.0 * kRadians;  // a vertex on a straight edge
constexpr double kCorner_rad = 20.0 * kRadians;   // less of a turn is a curve, and no corner
constexpr double kRimTurn_rad = 46.0 * kRadians;  // eight corners or more make a circle
constexpr double kRound = 0.01;                   // of the radius: how round a rim must be

using Loop = std::vector<std::uint32_t>;

// What an image shows of a mesh: the corners where edges meet, edges between them, flat faces and
// round rims. Curved surfaces have none of these and are left out.
class MeshModel {
 public:
  MeshModel(const Input& input, const MeshRegions& mesh, double scale)
      : input_(input), mesh_(mesh), scale_(scale) {
    for (const auto& [key, side] : mesh.sides) {
      if (!side.sharp) continue;
      sharp_[key.first].push_back(key.second);
      sharp_[key.second].push_back(key.first);
    }
  }

  ModelDraft build() {
    find_rims();
    find_corners();
    make_edges();
    make_faces();
    draft_.edges_listed = true;
    draft_.model.unit_scale = scale_;
    if (draft_.model.points.empty() && draft_.model.circles.empty()) {
      refuse(input_,
             "has no corners and no round rims: a smooth surface of " +
                 std::to_string(mesh_.vertices.size()) +
                 " vertices shows no feature points; list them in a model file (JSON)");
    }
    if (curved_ > 0) {
      draft_.warnings.push_back(std::to_string(curved_) +
                                " pieces of curved surfaces were left out: they hide nothing");
    }
    return std::move(draft_);
  }

 private:
  const Eigen::Vector3d& at(std::uint32_t v) const { return mesh_.vertices[v]; }

  // How far the edge turns at a vertex in which just two of them meet.
  double turn_rad(std::uint32_t v) const {
    const auto& ends = sharp_.at(v);
    const Eigen::Vector3d in = (at(v) - at(ends[0])).normalized();
    const Eigen::Vector3d out = (at(ends[1]) - at(v)).normalized();
    return std::atan2(in.cross(out).norm(), in.dot(out));
  }

  bool bends_gently(std::uint32_t v) const {
    return sharp_.at(v).size() == 2 && turn_rad(v) < kRimTurn_rad;
  }

  // Closed loops of edges that meet two at a time and bend a little at each vertex.
  void find_rims() {
    std::set<std::uint32_t> visited;
    for (const auto& [start, ends] : sharp_) {
      if (visited.contains(start) || !bends_gently(start)) continue;
      Loop loop{start};
      std::uint32_t before = start;
      std::uint32_t now = ends[0];
      while (now != start && bends_gently(now) && loop.size() <= mesh_.vertices.size()) {
        loop.push_back(now);
        const auto& next = sharp_.at(now);
        const std::uint32_t after = next[0] == before ? next[1] : next[0];
        before = now;
        now = after;
      }
      visited.insert(loop.begin(), loop.end());
      if (now == start) add_rim(loop);
    }
  }

  void add_rim(const Loop& loop) {
    constexpr std::size_t kFewest = 8;
    if (loop.size() < kFewest) return;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const std::uint32_t v : loop) centre += at(v) / static_cast<double>(loop.size());
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    double radius = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      area += (at(loop[i]) - centre).cross(at(loop[(i + 1) % loop.size()]) - centre);
      radius += (at(loop[i]) - centre).norm() / static_cast<double>(loop.size());
    }
    const Eigen::Vector3d normal = area.normalized();
    const bool round = std::all_of(loop.begin(), loop.end(), [&](std::uint32_t v) {
      const Eigen::Vector3d out = at(v) - centre;
      return std::abs(out.norm() - radius) <= kRound * radius &&
             std::abs(out.dot(normal)) <= kRound * radius;
    });
    if (!round) return;
    rims_.insert(loop.begin(), loop.end());
    draft_.model.circles.push_back({centre * scale_, outward(loop, normal), radius * scale_});
    require_at_most(input_, draft_.model.circles.size(), kMaxModelCircles, "round rims");
  }

  // The side on which the flat face at the rim looks; without one, as the rim runs.
  Eigen::Vector3d outward(const Loop& loop, const Eigen::Vector3d& normal) const {
    constexpr double kAlong = 0.999;  // cosine
    const auto side = mesh_.sides.find(std::minmax(loop[0], loop[1]));
    if (side == mesh_.sides.end()) return normal;
    for (const std::uint32_t region : side->second.regions) {
      const double along = mesh_.regions[region].normal.dot(normal);
      if (std::abs(along) > kAlong) return along > 0.0 ? normal : Eigen::Vector3d(-normal);
    }
    return normal;
  }

  void find_corners() {
    for (const auto& [v, ends] : sharp_) {
      if (rims_.contains(v)) continue;
      if (ends.size() == 2 && turn_rad(v) < kCorner_rad) continue;
      corner_.emplace(v, static_cast<std::uint32_t>(corner_.size()));
      draft_.model.points.push_back({FeatureType::kVertex, at(v) * scale_});
    }
    if (corner_.size() > kMaxModelPoints) {
      refuse(input_,
             "has " + std::to_string(corner_.size()) +
                 " corners after flat neighbours were joined (of " +
                 std::to_string(mesh_.vertices.size()) + " vertices), want at most " +
                 std::to_string(kMaxModelPoints) +
                 ": simplify the mesh, or list the points that matter in a model file (JSON)");
    }
  }

  // From each corner along the edge to the next one; curved stretches are no straight edges.
  void make_edges() {
    std::set<std::array<std::uint32_t, 2>> edges;
    for (const auto& [v, number] : corner_) {
      for (const std::uint32_t first : sharp_.at(v)) {
        std::uint32_t before = v;
        std::uint32_t now = first;
        bool straight = true;
        std::size_t steps = 0;
        while (!corner_.contains(now) && !rims_.contains(now) && ++steps < mesh_.vertices.size()) {
          straight = straight && turn_rad(now) < kStraight_rad;
          const auto& next = sharp_.at(now);
          const std::uint32_t after = next[0] == before ? next[1] : next[0];
          before = now;
          now = after;
        }
        const auto end = corner_.find(now);
        if (!straight || end == corner_.end() || end->second == number) continue;
        edges.insert({std::min(number, end->second), std::max(number, end->second)});
      }
    }
    require_at_most(
        input_, edges.size(), kMaxModelEdges, "edges after flat neighbours were joined");
    draft_.model.edges.assign(edges.begin(), edges.end());
  }

  // True when the outline runs along edges only; a smooth side is where a curved surface goes on.
  bool bounded(const Loop& outline) const {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto side =
          mesh_.sides.find(std::minmax(outline[i], outline[(i + 1) % outline.size()]));
      if (side == mesh_.sides.end() || !side->second.sharp) return false;
    }
    return true;
  }

  Loop corners_of(const Loop& outline) const {
    Loop corners;
    for (const std::uint32_t v : outline) {
      const auto corner = corner_.find(v);
      if (corner != corner_.end()) corners.push_back(corner->second);
    }
    return corners;
  }

  void make_faces() {
    for (const MeshRegions::Region& region : mesh_.regions) {
      const bool flat = !region.outlines.empty() &&
                        std::all_of(region.outlines.begin(),
                                    region.outlines.end(),
                                    [&](const Loop& outline) { return bounded(outline); });
      if (!flat) {
        ++curved_;
        continue;
      }
      Loop face = corners_of(region.outlines.front());
      if (face.size() < 3) continue;  // a round cap: the circle stands for it
      for (std::size_t hole = 1; hole < region.outlines.size(); ++hole) {
        const Loop inner = corners_of(region.outlines[hole]);
        if (inner.size() > 2) cut(face, inner);
      }
      draft_.model.faces.push_back(std::move(face));
    }
    require_at_most(input_,
                    draft_.model.faces.size(),
                    kMaxModelFaces,
                    "faces after flat neighbours were joined");
  }

  // Joins a hole to the outline by a bridge between the two corners that are nearest.
  void cut(Loop& face, const Loop& hole) const {
    std::size_t from = 0;
    std::size_t to = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < face.size(); ++i) {
      for (std::size_t j = 0; j < hole.size(); ++j) {
        const double distance =
            (draft_.model.points[face[i]].xyz - draft_.model.points[hole[j]].xyz).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        from = i;
        to = j;
      }
    }
    Loop joined(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(from) + 1);
    for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(to + k) % hole.size()]);
    joined.insert(joined.end(), face.begin() + static_cast<std::ptrdiff_t>(from), face.end());
    face = std::move(joined);
  }

  const Input& input_;
  const MeshRegions& mesh_;
  double scale_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> sharp_{};  // a vertex: where its edges lead
  std::set<std::uint32_t> rims_{};
  std::map<std::uint32_t, std::uint32_t> corner_{};  // vertex to point
  std::size_t curved_ = 0;
  ModelDraft draft_{};
};

}  // namespace

ModelDraft parse_mesh_model(const Input& input, const ReadModelOptions& options) {
  const Mesh mesh = parse_polygons(input, kMaxMeshVertices);
  if (mesh.polygons.empty()) {
    refuse(input,
           "has " + std::to_string(mesh.vertices.size()) +
               " vertices and no faces, want a polyhedron");
  }
  const MeshRegions regions = find_regions(input, mesh);
  return MeshModel(input, regions, metres_per(options.units.value_or(Units::kMetres))).build();
}

}  // namespace landmarkdb
