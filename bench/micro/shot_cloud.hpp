#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::bench {

// A generated lobby as it is indexed: one point a voxel, unit normals, keypoints on structure.
struct ShotCloud {
  PreparedCloud cloud;
  Keypoints keypoints;
};

// Same arguments, same cloud. At most `keypoints` of them, evenly picked; 0: all.
ShotCloud make_shot_cloud(std::size_t scan_points, std::size_t keypoints, std::uint64_t seed);

}  // namespace landmarkdb::bench
