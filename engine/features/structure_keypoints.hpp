#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Of each voxel of edge `spacing_m` the point nearest the voxel's centre (the lower index of two as
// near). Voxels are counted from the cloud's smallest corner.
Keypoints uniform_keypoints(const PreparedCloud& cloud, double spacing_m);

// How far the normals spread around each of `keypoints`: the second eigenvalue of mean(n n^T) over
// the points nearer than `radius_m`. 0 on a plane, 1/2 along the edge of two even sides, 1/3 where
// normals point everywhere alike. One value a keypoint.
std::vector<float> normal_spread(const PreparedCloud& cloud,
                                 const Keypoints& keypoints,
                                 double radius_m,
                                 const RunContext& context);

}  // namespace landmarkdb
