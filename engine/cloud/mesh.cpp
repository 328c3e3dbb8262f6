#include "engine/cloud/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "engine/base/random.hpp"
#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/scalar.hpp"

namespace landmarkdb {
namespace {

constexpr double kDefaultSpacings = 300.0;        // of the diagonal, where no spacing is asked for
constexpr double kMostDefaultSamples = 5e6;       // a crumpled mesh gets wider spacing instead
constexpr double kFewestDefaultSamples = 1000.0;  // a needle of a mesh gets narrower spacing
constexpr std::uint64_t kSeed = 1;

double triangle_area(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
  const double area =
      0.5 * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).norm();
  return std::isfinite(area) ? area : 0.0;
}

double diagonal(const Mesh& mesh) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector3d high = -low;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      const Eigen::Vector3d& p = mesh.vertices[corner];
      if (!p.allFinite()) continue;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  return (high - low).norm();
}

// A directed edge as one number.
std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) {
  return (std::uint64_t{from} << 32U) | to;
}

// Vertices at one place get one number, so that faces which do not share them (STL) still meet.
std::vector<std::uint32_t> weld(const Input& input, const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::uint64_t compared = 0;
  auto less = [&](std::uint32_t a, std::uint32_t b) {
    input.tick(++compared, input.size());  // a throw leaves `order` in no order, and unused
    const Eigen::Vector3d& p = mesh.vertices[a];
    const Eigen::Vector3d& q = mesh.vertices[b];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && mesh.vertices[order[k]] == mesh.vertices[order[k - 1]];
    place[order[k]] = same ? place[order[k - 1]] : order[k];
  }
  return place;
}

// +1 where the faces of a closed mesh look outwards, -1 inwards, 0 when it is open, wound
// inconsistently, or not finite.
double outward_sign(const Input& input, const Mesh& mesh) {
  const bool finite = std::all_of(mesh.vertices.begin(),
                                  mesh.vertices.end(),
                                  [](const Eigen::Vector3d& p) { return p.allFinite(); });
  if (!finite) return 0.0;
  const std::vector<std::uint32_t> place = weld(input, mesh);
  std::vector<std::uint64_t> edges, reversed;
  const Eigen::Vector3d centre = mesh.vertices[mesh.triangles[0][0]];
  double volume = 0.0;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = place[triangle[k]];
      const std::uint32_t to = place[triangle[(k + 1) % 3]];
      if (from == to) continue;
      edges.push_back(edge_key(from, to));
      reversed.push_back(edge_key(to, from));
    }
    volume +=
        (mesh.vertices[triangle[0]] - centre)
            .dot((mesh.vertices[triangle[1]] - centre).cross(mesh.vertices[triangle[2]] - centre));
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  if (edges != reversed) return 0.0;
  return volume > 0.0 ? 1.0 : volume < 0.0 ? -1.0 : 0.0;
}

struct Barycentric {
  double u = 0.0, v = 0.0;
};

// Point k of the R2 sequence (Roberts 2018), folded into the triangle.
Barycentric spread(std::uint64_t k, double offset_u, double offset_v) {
  constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;
  double whole = 0.0;
  Barycentric at{std::modf(offset_u + kStepU * static_cast<double>(k), &whole),
                 std::modf(offset_v + kStepV * static_cast<double>(k), &whole)};
  if (at.u + at.v > 1.0) at = {1.0 - at.u, 1.0 - at.v};
  return at;
}

template <typename Vector>
Vector blend(const std::vector<Vector>& values,
             const std::array<std::uint32_t, 3>& triangle,
             const Barycentric& at) {
  using Scalar = typename Vector::Scalar;
  return static_cast<Scalar>(1.0 - at.u - at.v) * values[triangle[0]] +
         static_cast<Scalar>(at.u) * values[triangle[1]] +
         static_cast<Scalar>(at.v) * values[triangle[2]];
}

std::array<std::uint8_t, 3> blend_colour(const Mesh& mesh,
                                         const std::array<std::uint32_t, 3>& triangle,
                                         const Barycentric& at) {
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = (1.0 - at.u - at.v) * mesh.colours[triangle[0]][c] +
                         at.u * mesh.colours[triangle[1]][c] + at.v * mesh.colours[triangle[2]][c];
    colour[c] = static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
  }
  return colour;
}

// The area one sample stands for, in square file units.
double area_per_sample(const Input& input,
                       const Mesh& mesh,
                       double total_area,
                       const ReadOptions& options) {
  const double spacing = options.mesh_spacing_m / metres_per(options.units);
  if (spacing < 0.0 || !std::isfinite(spacing)) {
    refuse(
        input,
        "mesh spacing of " + std::to_string(options.mesh_spacing_m) + " m, want a positive length");
  }
  if (spacing == 0.0) {
    const double step = diagonal(mesh) / kDefaultSpacings;
    const double most = std::min(kMostDefaultSamples, static_cast<double>(options.max_points));
    const double fewest = std::min(kFewestDefaultSamples, most);
    return std::clamp(
        step * step, total_area / std::max(most, 1.0), total_area / std::max(fewest, 1.0));
  }
  const double samples = total_area / (spacing * spacing);
  if (!(samples <= static_cast<double>(options.max_points))) {
    refuse(input,
           "a mesh sampled every " + std::to_string(options.mesh_spacing_m) +
               " m would have more than " + std::to_string(options.max_points) + " points");
  }
  return spacing * spacing;
}

// Normals for the samples: from the vertices, from the faces times `sign`, or none.
void add_normal(CloudBuilder& builder,
                const Mesh& mesh,
                const std::array<std::uint32_t, 3>& triangle,
                const Barycentric& at,
                double sign) {
  if (mesh.normals.size() == mesh.vertices.size()) {
    builder.add_normal(blend(mesh.normals, triangle, at).cast<double>().normalized());
    return;
  }
  if (sign == 0.0) return;
  const Eigen::Vector3d& a = mesh.vertices[triangle[0]];
  builder.add_normal(
      sign * (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a).normalized());
}

}  // namespace

void add_polygon(Mesh& mesh, std::span<const std::uint32_t> corners) {
  if (mesh.keep_polygons) {
    if (corners.size() > 2) mesh.polygons.emplace_back(corners.begin(), corners.end());
    return;
  }
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

PointCloud sample_mesh(const Input& input, const Mesh& mesh, const ReadOptions& options) {
  double total = 0.0;
  for (const auto& triangle : mesh.triangles) total += triangle_area(mesh, triangle);
  if (!(total > 0.0) || !std::isfinite(total)) {
    refuse(input,
           "a mesh of " + std::to_string(mesh.vertices.size()) + " vertices and " +
               std::to_string(mesh.triangles.size()) + " triangles has no area to sample");
  }
  const double each = area_per_sample(input, mesh, total, options);
  if (!(each > 0.0)) refuse(input, "a mesh whose area is too small for double");
  const double sign = mesh.normals.empty() ? outward_sign(input, mesh) : 0.0;
  const bool colours = mesh.colours.size() == mesh.vertices.size();
  CloudBuilder builder(metres_per(options.units));
  Random random(kSeed);
  double due = random.uniform();  // samples owed to the surface walked so far
  std::uint64_t turns = 0;
  const auto tick = [&](std::size_t triangle) {
    constexpr std::uint64_t kTurns = 8192;  // about a millisecond
    if (input.context != nullptr && turns++ % kTurns == 0) {
      input.context->report("sample", triangle, mesh.triangles.size());
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    tick(t);
    due += triangle_area(mesh, triangle) / each;
    const double offset_u = random.uniform();
    const double offset_v = random.uniform();
    const auto samples = static_cast<std::uint64_t>(due);
    due -= static_cast<double>(samples);
    for (std::uint64_t k = 0; k < samples && builder.size() < options.max_points; ++k) {
      tick(t);
      const Barycentric at = spread(k, offset_u, offset_v);
      builder.add_point(blend(mesh.vertices, triangle, at));
      add_normal(builder, mesh, triangle, at, sign);
      if (colours) builder.add_colour(blend_colour(mesh, triangle, at));
    }
  }
  if (builder.size() == 0) {
    refuse(input,
           "a mesh too small to be sampled every " + std::to_string(options.mesh_spacing_m) + " m");
  }
  return builder.finish();
}

}  // namespace landmarkdb
