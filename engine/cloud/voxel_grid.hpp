#pragma once

#include <cstdint>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// One point a voxel of edge `voxel_m`: the mean of the voxel's points by their weights (normals
// averaged and renormalised, colours averaged, the viewpoint of the voxel's first point). Voxel
// keys are 64-bit, so no extent overflows; voxels come out ordered by key, so the result does not
// depend on the order of the points beyond float rounding. Throws Error{kInvalidArgument} for a
// voxel that is not positive and finite, and what `context.check` does.
PointCloud thin(const PointCloud& cloud, double voxel_m, const RunContext& context = {});

// Leaves one point a cell of edge `cell_m`, as thin does, with its weight, at the place of the
// cell's first one: thinned afterwards to voxels of whole cells, the cloud is what it would have
// been but for float rounding, colours, and normals, of which each cell's mean has unit length. Its
// rows and columns are gone. Memory beside what is left: some 20 bytes a point, 40 where cells and
// points cannot be numbered together in 64 bits (a hall of 60 m in cells of 3 mm). Throws as thin;
// the cloud is then of no use.
void condense(PointCloud& cloud, double cell_m, const RunContext& context = {});

}  // namespace landmarkdb
