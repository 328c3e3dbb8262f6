#pragma once

#include "engine/cloud/input.hpp"
#include "engine/cloud/mesh.hpp"
#include "engine/cloud/read_cloud.hpp"

namespace landmarkdb {

// A PLY file, ascii or binary; with faces it is a mesh and sampled. Throws Error{kInvalidArgument}.
void parse_ply(const Input& input, const ReadOptions& options, const CloudSink& sink);

// Its vertices (in file units) and its faces as polygons, none where it has only points.
Mesh parse_ply_polygons(const Input& input, const ReadOptions& options);

}  // namespace landmarkdb
