#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/registration/surface_grid.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// A place's surface as far as it takes to tell which of many places a query may be of: points some
// voxels apart with their normals, the frame of the record.
struct PlaceOutline {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  // one a point, unit length
};

// Of a place, a tenth of its points.
PlaceOutline make_place_outline(const PreparedCloud& cloud);

// The grid of an outline of a place described at this resolution: half of what the wide grid of an
// entry takes, and it knows the right place among others as well. Throws what SurfaceGrid does.
SurfaceGrid outline_grid(const PlaceOutline& outline, double voxel_m);

// Points of the cloud a cell apart, with their normals.
PlaceOutline thinned_outline(const PreparedCloud& cloud, double cell_m);

}  // namespace landmarkdb
