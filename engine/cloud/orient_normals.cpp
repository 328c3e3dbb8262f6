#include "engine/cloud/orient_normals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/parallel.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kNeighbours = 9;    // the point and 8 around it: enough to connect a surface
constexpr float kLargestObject_m = 2.5F;  // a part wider than this is taken for a room or a street

struct Edge {
  float cost = 0.0F;  // 1 - |cosine|
  std::uint32_t a = 0, b = 0;
};

std::vector<Edge> neighbour_graph(std::span<const Eigen::Vector3f> points,
                                  std::span<const Eigen::Vector3f> normals,
                                  const SpatialIndex& index,
                                  const RunContext& context) {
  constexpr std::size_t kEach = kNeighbours - 1;
  constexpr float kNoEdge = -1.0F;
  constexpr std::size_t kStep = 1024;  // points between two looks at the stop token
  std::vector<Edge> edges(points.size() * kEach, Edge{kNoEdge, 0, 0});
  parallel_chunks(points.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbour> neighbours;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kStep == 0 && context.should_stop()) return;
      index.nearest(points[i], kNeighbours, neighbours);
      std::size_t used = 0;
      for (const Neighbour& neighbour : neighbours) {
        if (neighbour.index == i || used == kEach) continue;
        const float cosine = std::abs(normals[i].dot(normals[neighbour.index]));
        edges[i * kEach + used++] = {
            std::max(0.0F, 1.0F - cosine), static_cast<std::uint32_t>(i), neighbour.index};
      }
    }
  });
  context.check("normals");
  std::erase_if(edges, [](const Edge& edge) { return edge.cost < 0.0F; });
  return edges;
}

// Parts and, in each, the sign of every point against the part's root (union-find with parity).
class SignedParts {
 public:
  explicit SignedParts(std::size_t n) : parent_(n), size_(n, 1), flipped_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  struct Root {
    std::uint32_t part = 0;
    bool flipped = false;
  };

  Root find(std::uint32_t i) {
    Root root{i, false};
    while (parent_[root.part] != root.part) {
      root.flipped ^= flipped_[root.part] != 0;
      root.part = parent_[root.part];
    }
    bool flipped = root.flipped;
    while (parent_[i] != i && parent_[i] != root.part) {
      const std::uint32_t next = parent_[i];
      const bool step = flipped_[i] != 0;
      parent_[i] = root.part;
      flipped_[i] = flipped ? 1 : 0;
      flipped ^= step;
      i = next;
    }
    return root;
  }

  // Joins two parts so that the normals of a and b get opposite signs if `opposite`, else the same.
  void join(std::uint32_t a, std::uint32_t b, bool opposite) {
    Root root_a = find(a);
    Root root_b = find(b);
    if (root_a.part == root_b.part) return;
    if (size_[root_a.part] < size_[root_b.part]) std::swap(root_a, root_b);
    parent_[root_b.part] = root_a.part;
    flipped_[root_b.part] = (root_a.flipped ^ root_b.flipped ^ opposite) ? 1 : 0;
    size_[root_a.part] += size_[root_b.part];
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> size_;
  std::vector<std::uint8_t> flipped_;  // against the parent
};

struct Part {
  std::size_t points = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector3f high = Eigen::Vector3f::Constant(std::numeric_limits<float>::lowest());
  // Sums of cosines between normals and the directions away from a centre.
  double from_own_centre = 0.0;
  double from_scene_centre = 0.0;
};

double cosine_from(const Eigen::Vector3d& centre,
                   const Eigen::Vector3f& point,
                   const Eigen::Vector3f& normal) {
  const Eigen::Vector3d away = point.cast<double>() - centre;
  const double distance = away.norm();
  return distance > 0.0 ? normal.cast<double>().dot(away) / distance : 0.0;
}

// Parts by the index of their root; `scene` gets the same figures of all points.
std::vector<Part> measure_parts(std::span<const Eigen::Vector3f> points,
                                std::span<const Eigen::Vector3f> normals,
                                const std::vector<std::uint32_t>& part_of,
                                Part& scene) {
  std::vector<Part> parts(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (Part* part : {&parts[part_of[i]], &scene}) {
      ++part->points;
      part->sum += points[i].cast<double>();
      part->low = part->low.cwiseMin(points[i]);
      part->high = part->high.cwiseMax(points[i]);
    }
  }
  const Eigen::Vector3d scene_centre = scene.sum / static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Part& part = parts[part_of[i]];
    const Eigen::Vector3d own_centre = part.sum / static_cast<double>(part.points);
    part.from_own_centre += cosine_from(own_centre, points[i], normals[i]);
    part.from_scene_centre += cosine_from(scene_centre, points[i], normals[i]);
  }
  return parts;
}

bool is_object(const Part& part) { return (part.high - part.low).maxCoeff() <= kLargestObject_m; }

// Whether a part's normals look away from where they should.
bool wants_turn(const Part& part, const Part& scene) {
  // Mean cosine above which a part bulges enough to have an inside; a sphere has 1, a plane 0.
  constexpr double kBulges = 0.4;
  const bool bulges = std::abs(part.from_own_centre) > kBulges * static_cast<double>(part.points);
  if (is_object(part) && bulges) return part.from_own_centre < 0.0;
  return is_object(scene) ? part.from_scene_centre < 0.0 : part.from_scene_centre > 0.0;
}

}  // namespace

void orient_consistently(std::span<const Eigen::Vector3f> points,
                         std::span<Eigen::Vector3f> normals,
                         const SpatialIndex& index,
                         const RunContext& context) {
  std::vector<Edge> edges = neighbour_graph(points, normals, index, context);
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    if (x.cost != y.cost) return x.cost < y.cost;
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  context.check("normals");
  SignedParts signs(points.size());
  for (const Edge& edge : edges) {
    signs.join(edge.a, edge.b, normals[edge.a].dot(normals[edge.b]) < 0.0F);
  }
  std::vector<std::uint32_t> part_of(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const SignedParts::Root root = signs.find(i);
    part_of[i] = root.part;
    if (root.flipped) normals[i] = -normals[i];
  }
  Part scene;
  const std::vector<Part> parts = measure_parts(points, normals, part_of, scene);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (wants_turn(parts[part_of[i]], scene)) normals[i] = -normals[i];
  }
}

}  // namespace landmarkdb
