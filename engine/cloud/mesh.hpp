#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Triangles over shared vertices, in file units. `normals` and `colours` are empty or one a vertex.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // Set before reading, faces are kept as they are written and not split into triangles.
  bool keep_polygons = false;
  std::vector<std::vector<std::uint32_t>> polygons;
};

// Adds a polygon (indices of vertices, at least three), as a fan around its first corner unless
// polygons are kept.
void add_polygon(Mesh& mesh, std::span<const std::uint32_t> corners);

// Points spread evenly over the surface, about options.mesh_spacing_m apart: as many on each
// triangle as its area asks for, placed by a low-discrepancy sequence, the same on every run.
// Normals and colours are interpolated where the vertices have them; else the faces give the
// normals if the mesh is closed and wound consistently (then they point outwards). Throws
// Error{kInvalidArgument} without any area, or when the spacing asks for more than
// options.max_points.
PointCloud sample_mesh(const Input& input, const Mesh& mesh, const ReadOptions& options);

}  // namespace landmarkdb
