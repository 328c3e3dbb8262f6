#pragma once

#include <span>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// One cloud of several scans of one place, as CloudMerger makes it. `T_scene_cloud[i]` carries
// cloud i into the scene frame. Clouds must be sanitised. Throws what CloudMerger does.
PointCloud merge_clouds(std::span<const PointCloud> clouds,
                        std::span<const Eigen::Isometry3d> T_scene_cloud,
                        const RunContext& context = {});

}  // namespace landmarkdb
