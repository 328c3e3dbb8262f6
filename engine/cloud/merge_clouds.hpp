#pragma once

#include <span>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// One cloud of several scans of one place. `T_scene_cloud[i]` carries cloud i into the scene frame;
// points, normals, viewpoints and origins are carried along, and each point keeps the viewpoint it
// was seen from. The origin of the result is chosen so that its float points stay small. Colours
// are kept when all clouds have them, normals likewise; viewpoints are dropped unless all have one.
// Clouds must be sanitised. Throws what `context.check` does.
PointCloud merge_clouds(std::span<const PointCloud> clouds,
                        std::span<const Eigen::Isometry3d> T_scene_cloud,
                        const RunContext& context = {});

}  // namespace landmarkdb
