#include "engine/mono/mesh_regions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

namespace landmarkdb {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
// Polygons of one face differ by rounding only; a finely cut sphere's neighbours by a degree.
constexpr double kOnePlane_rad = 0.5 * kRadians;
// Below this two faces are pieces of one curved surface: eighteen sides to a cylinder.
constexpr double kSharp_rad = 20.0 * kRadians;
constexpr double kSamePlace = 1e-6;   // of the extent
constexpr double kOffPlane = 1e-3;    // of the extent: how far a region may stray from its seed
constexpr double kLeastArea = 1e-10;  // of the squared extent

using Polygon = std::vector<std::uint32_t>;
using Key = std::pair<std::uint32_t, std::uint32_t>;

class RegionFinder {
 public:
  RegionFinder(const Input& input, const Mesh& mesh) : input_(input), mesh_(mesh) {}

  MeshRegions find() {
    measure();
    weld();
    take_polygons();
    grow_regions();
    make_sides();
    for (std::uint32_t r = 0; r < result_.regions.size(); ++r) make_outlines(r);
    return std::move(result_);
  }

 private:
  void measure() {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);
    Eigen::Vector3d high = -low;
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
      const Eigen::Vector3d& v = mesh_.vertices[i];
      constexpr double kFarthest = 1e12;
      if (!v.allFinite() || v.cwiseAbs().maxCoeff() > kFarthest) {
        refuse(input_, "vertex " + std::to_string(i) + " has a coordinate that is not finite");
      }
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    result_.extent = (high - low).norm();
    if (!(result_.extent > 0.0)) refuse(input_, "all its vertices lie at one place");
  }

  // Vertices at one place become one: many writers give each face its own.
  void weld() {
    const double cell = kSamePlace * result_.extent;
    std::vector<std::uint32_t> order(mesh_.vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return mesh_.vertices[a].x() < mesh_.vertices[b].x();
    });
    std::vector<std::uint32_t> parent(order.size());
    std::iota(parent.begin(), parent.end(), 0U);
    std::uint64_t turn = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Eigen::Vector3d& v = mesh_.vertices[order[i]];
      for (std::size_t j = i; j-- > 0;) {
        input_.tick(++turn, input_.bytes.size());
        const Eigen::Vector3d& w = mesh_.vertices[order[j]];
        if (v.x() - w.x() > cell) break;
        if ((v - w).norm() > cell) continue;
        parent[order[i]] = parent[order[j]];
        break;
      }
    }
    welded_.assign(order.size(), 0);
    std::map<std::uint32_t, std::uint32_t> number;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const auto [at, fresh] =
          number.emplace(parent[i], static_cast<std::uint32_t>(result_.vertices.size()));
      if (fresh) result_.vertices.push_back(mesh_.vertices[parent[i]]);
      welded_[i] = at->second;
    }
  }

  Eigen::Vector3d area_of(const Polygon& polygon) const {
    const Eigen::Vector3d& origin = result_.vertices[polygon.front()];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      sum +=
          (result_.vertices[polygon[i]] - origin).cross(result_.vertices[polygon[i + 1]] - origin);
    }
    return sum;
  }

  void take_polygons() {
    for (const auto& corners : mesh_.polygons) {
      Polygon polygon;
      for (const std::uint32_t corner : corners) {
        if (polygon.empty() || polygon.back() != welded_[corner])
          polygon.push_back(welded_[corner]);
      }
      while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
      if (polygon.size() < 3) continue;
      const Eigen::Vector3d area = area_of(polygon);
      // Slivers too thin for a normal still carry sides: they join whatever lies beside them.
      sliver_.push_back(area.norm() < kLeastArea * result_.extent * result_.extent);
      normals_.push_back(area.normalized());
      areas_.push_back(area.norm());
      polygons_.push_back(std::move(polygon));
    }
    if (std::find(sliver_.begin(), sliver_.end(), false) == sliver_.end()) {
      refuse(input_, "has no face with an area, want a polyhedron");
    }
    for (std::uint32_t p = 0; p < polygons_.size(); ++p) {
      for_sides(polygons_[p],
                [&](std::uint32_t a, std::uint32_t b) { users_[std::minmax(a, b)].push_back(p); });
    }
  }

  template <typename Visit>
  static void for_sides(const Polygon& polygon, const Visit& visit) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      visit(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
  }

  bool fits(std::uint32_t polygon, std::uint32_t seed) const {
    const Eigen::Vector3d& normal = normals_[seed];
    if (!sliver_[polygon] && normals_[polygon].dot(normal) < std::cos(kOnePlane_rad)) return false;
    const Eigen::Vector3d& origin = result_.vertices[polygons_[seed].front()];
    return std::all_of(polygons_[polygon].begin(), polygons_[polygon].end(), [&](std::uint32_t v) {
      return std::abs(normal.dot(result_.vertices[v] - origin)) <= kOffPlane * result_.extent;
    });
  }

  // From the largest polygon on, each takes in its neighbours of the same plane.
  void grow_regions() {
    std::vector<std::uint32_t> order(polygons_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return areas_[a] > areas_[b];
    });
    region_of_.assign(polygons_.size(), std::nullopt);
    for (const std::uint32_t seed : order) {
      if (region_of_[seed] || sliver_[seed]) continue;
      const auto region = static_cast<std::uint32_t>(result_.regions.size());
      result_.regions.push_back({normals_[seed]});
      region_of_[seed] = region;
      std::vector<std::uint32_t> front{seed};
      for (std::size_t at = 0; at < front.size(); ++at) {
        input_.tick(at, input_.bytes.size());
        for_sides(polygons_[front[at]], [&](std::uint32_t a, std::uint32_t b) {
          const std::vector<std::uint32_t>& users = users_.at(std::minmax(a, b));
          if (users.size() != 2) return;  // a border, or a side of several sheets
          const std::uint32_t other = users[0] == front[at] ? users[1] : users[0];
          if (region_of_[other] || !fits(other, seed)) return;
          region_of_[other] = region;
          front.push_back(other);
        });
      }
    }
  }

  void make_sides() {
    for (const auto& [key, users] : users_) {
      MeshRegions::Side side;
      for (const std::uint32_t p : users) {
        if (region_of_[p]) side.regions.push_back(*region_of_[p]);
      }
      if (side.regions.empty()) continue;
      if (side.regions.size() == 2 && side.regions[0] == side.regions[1]) continue;
      side.sharp = side.regions.size() != 2 ||
                   result_.regions[side.regions[0]].normal.dot(
                       result_.regions[side.regions[1]].normal) < std::cos(kSharp_rad);
      result_.sides.emplace(key, std::move(side));
    }
  }

  // What is left of the polygons' sides once those between two of them are gone, as loops.
  void make_outlines(std::uint32_t region) {
    if (next_.empty()) collect_border();
    MeshRegions::Region& made = result_.regions[region];
    std::map<std::uint32_t, std::vector<std::uint32_t>>& next = next_[region];
    while (!next.empty()) {
      Polygon outline;
      std::uint32_t at = next.begin()->first;
      for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
        outline.push_back(at);
        at = step->second.back();
        step->second.pop_back();
        if (step->second.empty()) next.erase(step);
      }
      if (outline.size() > 2) made.outlines.push_back(std::move(outline));
    }
    std::stable_sort(
        made.outlines.begin(), made.outlines.end(), [&](const Polygon& a, const Polygon& b) {
          return area_of(a).dot(made.normal) > area_of(b).dot(made.normal);
        });
  }

  void collect_border() {
    next_.resize(result_.regions.size());
    for (std::uint32_t p = 0; p < polygons_.size(); ++p) {
      if (!region_of_[p]) continue;
      for_sides(polygons_[p], [&](std::uint32_t a, std::uint32_t b) {
        if (result_.sides.contains(std::minmax(a, b))) next_[*region_of_[p]][a].push_back(b);
      });
    }
  }

  const Input& input_;
  const Mesh& mesh_;
  MeshRegions result_{};
  std::vector<std::uint32_t> welded_{};
  std::vector<Polygon> polygons_{};
  std::vector<Eigen::Vector3d> normals_{};
  std::vector<double> areas_{};
  std::vector<bool> sliver_{};
  std::map<Key, std::vector<std::uint32_t>> users_{};
  std::vector<std::optional<std::uint32_t>> region_of_{};
  std::vector<std::map<std::uint32_t, std::vector<std::uint32_t>>> next_{};
};

}  // namespace

MeshRegions find_regions(const Input& input, const Mesh& mesh) {
  return RegionFinder(input, mesh).find();
}

}  // namespace landmarkdb
