#pragma once

#include "engine/cloud/input.hpp"
#include "engine/cloud/mesh.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// A Wavefront OBJ file in memory: vertices (with colours, where they have them) and faces of any
// number of corners, negative indices and continued lines included; materials, curves and texture
// are skipped. Without faces its vertices are the cloud. Throws Error{kInvalidArgument}.
PointCloud parse_obj(const Input& input, const ReadOptions& options);

// The vertices of an OBJ or PLY file (in file units) and its faces as polygons, none where it has
// only points. Throws Error{kInvalidArgument} past `max_vertices`, and as for a cloud.
Mesh parse_polygons(const Input& input, std::uint64_t max_vertices);

// True for a binary STL file: its length is exactly what its triangle count asks for.
bool is_binary_stl(const Input& input);

// An STL file in memory. Throws Error{kInvalidArgument}.
PointCloud parse_binary_stl(const Input& input, const ReadOptions& options);
PointCloud parse_ascii_stl(const Input& input, const ReadOptions& options);

}  // namespace landmarkdb
