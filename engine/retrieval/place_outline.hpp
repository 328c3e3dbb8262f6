#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/geometry/packed_rotation.hpp"
#include "engine/registration/surface_grid.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// Points of a surface some voxels apart with their normals, the frame of the cloud.
struct ThinSurface {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  // one a point, unit length
};

// A place as far as it takes to tell which of many places a query may be of. The frame of the
// record.
struct PlaceOutline {
  ThinSurface surface;
  std::vector<Eigen::Vector3f> keypoints;  // N, as the record has them
  std::vector<PackedRotation> frames;      // N local reference frames
};

// Of a place, a tenth of its points and all of its keypoints.
PlaceOutline make_place_outline(const SceneRecord& record);

// The grid of an outline of a place described at this resolution: half of what the wide grid of an
// entry takes, and it knows the right place among others as well. Throws what SurfaceGrid does.
SurfaceGrid outline_grid(const ThinSurface& surface, double voxel_m);

// Points of the cloud a cell apart, with their normals.
ThinSurface thinned_surface(const PreparedCloud& cloud, double cell_m);

}  // namespace landmarkdb
