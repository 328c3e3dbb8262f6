#include "datasets/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

namespace landmarkdb::datasets {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr int kBins = 16;
constexpr int kMaxDepth = 60;        // of the tree; the traversal stack holds one entry a level
constexpr float kNearest_m = 1e-4F;  // closer hits are the surface the ray starts on

struct Box {
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Array3f high = Eigen::Array3f::Constant(-std::numeric_limits<float>::infinity());

  void add(const Box& other) {
    low = low.min(other.low);
    high = high.max(other.high);
  }
  void add(const Eigen::Array3f& p) {
    low = low.min(p);
    high = high.max(p);
  }
  float half_area() const {
    const Eigen::Array3f d = (high - low).max(0.0F);
    return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
  }
};

// `count` 0: an inner node, its children at `first` and `first + 1`. Else a leaf: triangles
// `first`..`first + count`.
struct Node {
  std::array<float, 3> low, high;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

// A corner and the two edges from it, in the order of the leaves.
struct Triangle {
  std::array<float, 3> a, ab, ac;
  std::uint32_t index = 0;
};

std::array<float, 3> plain(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

std::array<float, 3> cross(const std::array<float, 3>& u, const std::array<float, 3>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

float dot(const std::array<float, 3>& u, const std::array<float, 3>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

struct Ray {
  std::array<float, 3> origin, direction, inverse;
};

Ray make_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  // A zero component would make 0 * infinity in the slab test; a tiny one does not.
  constexpr float kTiny = 1e-12F;
  const auto inverse = [](float d) {
    return 1.0F / (std::abs(d) < kTiny ? std::copysign(kTiny, d) : d);
  };
  return {plain(origin),
          plain(direction),
          {inverse(direction.x()), inverse(direction.y()), inverse(direction.z())}};
}

// Distance at which the ray enters the box, or infinity.
float enter(const Node& node, const Ray& ray, float limit) {
  float near = 0.0F;
  float far = limit;
  for (std::size_t k = 0; k < 3; ++k) {
    const float t0 = (node.low[k] - ray.origin[k]) * ray.inverse[k];
    const float t1 = (node.high[k] - ray.origin[k]) * ray.inverse[k];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near <= far * 1.00001F ? near : std::numeric_limits<float>::infinity();
}

// Moller and Trumbore 1997. Returns the distance, or a negative number.
float intersect(const Triangle& triangle, const Ray& ray) {
  const std::array<float, 3> p = cross(ray.direction, triangle.ac);
  const float determinant = dot(triangle.ab, p);
  if (determinant == 0.0F) return -1.0F;
  const float inverse = 1.0F / determinant;
  const std::array<float, 3> s = {
      ray.origin[0] - triangle.a[0], ray.origin[1] - triangle.a[1], ray.origin[2] - triangle.a[2]};
  // Rays must not slip between two triangles that share an edge.
  constexpr float kSlack = 1e-6F;
  const float u = dot(s, p) * inverse;
  if (!(u >= -kSlack && u <= 1.0F + kSlack)) return -1.0F;
  const std::array<float, 3> q = cross(s, triangle.ab);
  const float v = dot(ray.direction, q) * inverse;
  if (!(v >= -kSlack && u + v <= 1.0F + kSlack)) return -1.0F;
  return dot(triangle.ac, q) * inverse;
}

}  // namespace

struct RayCaster::Tree {
  std::vector<Node> nodes;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> glass;  // by mesh triangle

  // Build only.
  std::vector<Box> boxes;
  std::vector<Eigen::Array3f> centres;
  std::vector<std::uint32_t> order;

  void build(const TriangleMesh& mesh);
  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth);
  std::uint32_t reorder(std::uint32_t begin, std::uint32_t end, const Box& box);

  // Calls `accept(triangle, distance)` for every hit nearer than `limit`; it returns the new limit.
  template <typename Accept>
  void traverse(const Ray& ray, float limit, const Accept& accept) const;
};

void RayCaster::Tree::build(const TriangleMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  boxes.resize(n);
  centres.resize(n);
  order.resize(n);
  glass.resize(n);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = 0; i < n; ++i) {
    for (const std::uint32_t corner : mesh.triangles[i])
      boxes[i].add(mesh.vertices[corner].array());
    centres[i] = 0.5F * (boxes[i].low + boxes[i].high);
    glass[i] = mesh.objects[mesh.object[i]].material == Material::kGlass ? 1 : 0;
  }
  nodes.reserve(n);
  nodes.emplace_back();
  split(0, 0, static_cast<std::uint32_t>(n), 0);
  triangles.reserve(n);
  for (const std::uint32_t i : order) {
    const Eigen::Vector3f a = mesh.vertices[mesh.triangles[i][0]];
    triangles.push_back({plain(a),
                         plain(mesh.vertices[mesh.triangles[i][1]] - a),
                         plain(mesh.vertices[mesh.triangles[i][2]] - a),
                         i});
  }
  boxes = {};
  centres = {};
  order = {};
}

void RayCaster::Tree::split(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth) {
  Box box;
  for (std::uint32_t i = begin; i < end; ++i) box.add(boxes[order[i]]);
  nodes[node].low = plain(box.low.matrix());
  nodes[node].high = plain(box.high.matrix());
  const std::uint32_t middle =
      end - begin <= kLeafTriangles || depth >= kMaxDepth ? begin : reorder(begin, end, box);
  if (middle == begin || middle == end) {
    nodes[node].first = begin;
    nodes[node].count = end - begin;
    return;
  }
  const auto children = static_cast<std::uint32_t>(nodes.size());
  nodes[node].first = children;
  nodes.emplace_back();
  nodes.emplace_back();
  split(children, begin, middle, depth + 1);
  split(children + 1, middle, end, depth + 1);
}

// Sorts `order[begin, end)` into two parts by the cheapest of the binned planes and returns where
// the second one starts; `begin` when no cut pays.
std::uint32_t RayCaster::Tree::reorder(std::uint32_t begin, std::uint32_t end, const Box& box) {
  Box spread;
  for (std::uint32_t i = begin; i < end; ++i) spread.add(centres[order[i]]);
  float best_cost = static_cast<float>(end - begin) * box.half_area();
  int best_axis = -1;
  int best_bin = 0;
  const auto bin_of = [&](std::uint32_t i, int axis) {
    const float extent = spread.high[axis] - spread.low[axis];
    const float place = (centres[i][axis] - spread.low[axis]) / extent * static_cast<float>(kBins);
    return std::clamp(static_cast<int>(place), 0, kBins - 1);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!(spread.high[axis] - spread.low[axis] > 0.0F)) continue;
    std::array<Box, kBins> bins;
    std::array<std::uint32_t, kBins> counts{};
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(order[i], axis));
      bins[bin].add(boxes[order[i]]);
      ++counts[bin];
    }
    std::array<float, kBins> right_cost{};
    Box right;
    std::uint32_t right_count = 0;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      right.add(bins[bin]);
      right_count += counts[bin];
      right_cost[bin] =
          right_count == 0 ? 0.0F : right.half_area() * static_cast<float>(right_count);
    }
    Box left;
    std::uint32_t left_count = 0;
    for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
      left.add(bins[bin]);
      left_count += counts[bin];
      if (left_count == 0 || left_count == end - begin) continue;
      const float cost = left.half_area() * static_cast<float>(left_count) + right_cost[bin + 1];
      if (cost < best_cost) {
        best_cost = cost;
        best_axis = axis;
        best_bin = static_cast<int>(bin);
      }
    }
  }
  if (best_axis < 0) return begin;
  const auto middle =
      std::stable_partition(order.begin() + begin, order.begin() + end, [&](std::uint32_t i) {
        return bin_of(i, best_axis) <= best_bin;
      });
  return static_cast<std::uint32_t>(middle - order.begin());
}

template <typename Accept>
void RayCaster::Tree::traverse(const Ray& ray, float limit, const Accept& accept) const {
  struct Waiting {
    std::uint32_t node;
    float distance;
  };
  if (triangles.empty()) return;  // the root would be a leaf without triangles, that is, no leaf
  constexpr float kNever = std::numeric_limits<float>::infinity();
  std::array<Waiting, kMaxDepth + 4> stack;
  std::size_t waiting = 0;
  const float root = enter(nodes[0], ray, limit);
  if (root < kNever) stack[waiting++] = {0, root};
  while (waiting > 0) {
    const Waiting top = stack[--waiting];
    if (top.distance > limit) continue;
    const Node& node = nodes[top.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const float distance = intersect(triangles[i], ray);
      if (distance > kNearest_m && distance < limit) limit = accept(triangles[i], distance);
    }
    if (node.count > 0) continue;
    Waiting near = {node.first, enter(nodes[node.first], ray, limit)};
    Waiting far = {node.first + 1, enter(nodes[node.first + 1], ray, limit)};
    if (far.distance < near.distance) std::swap(near, far);
    if (far.distance < kNever) stack[waiting++] = far;
    if (near.distance < kNever) stack[waiting++] = near;
  }
}

RayCaster::RayCaster(const TriangleMesh& mesh) : tree_(std::make_unique<Tree>()) {
  tree_->build(mesh);
}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<Hit> RayCaster::first_hit(const Eigen::Vector3f& origin,
                                        const Eigen::Vector3f& direction,
                                        float max_distance_m) const {
  const Triangle* nearest = nullptr;
  float distance_m = max_distance_m;
  tree_->traverse(
      make_ray(origin, direction), max_distance_m, [&](const Triangle& triangle, float distance) {
        nearest = &triangle;
        return distance_m = distance;
      });
  if (nearest == nullptr) return std::nullopt;
  Hit hit;
  hit.distance_m = distance_m;
  hit.triangle = nearest->index;
  const std::array<float, 3> normal = cross(nearest->ab, nearest->ac);
  hit.normal = Eigen::Vector3f(normal[0], normal[1], normal[2]).normalized();
  hit.front_face = hit.normal.dot(direction) <= 0.0F;
  hit.returns_light = tree_->glass[nearest->index] == 0;
  return hit;
}

bool RayCaster::blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  constexpr float kMargin_m = 1e-3F;
  const Eigen::Vector3f way = to - from;
  const float length = way.norm();
  if (length <= 2.0F * kMargin_m) return false;
  const Eigen::Vector3f direction = way / length;
  bool found = false;
  tree_->traverse(make_ray(from + kMargin_m * direction, direction),
                  length - 2.0F * kMargin_m,
                  [&](const Triangle&, float) {
                    found = true;
                    return 0.0F;
                  });
  return found;
}

}  // namespace landmarkdb::datasets
