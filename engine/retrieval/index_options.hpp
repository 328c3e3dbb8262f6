#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// How an entry is to be described; what is left out is derived from the data.
struct IndexOptions {
  EntryKind kind = EntryKind::kPlace;
  std::optional<double> voxel_m;
  std::optional<double> radius_m;  // SHOT support
  KeypointMethod keypoints = KeypointMethod::kStructure;
  std::optional<Eigen::Vector3d> up;  // scene frame, any length > 0
};

}  // namespace landmarkdb
