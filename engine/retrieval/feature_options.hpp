#pragma once

#include <optional>

#include "engine/cloud/resolution.hpp"
#include "engine/features/detect_keypoints.hpp"
#include "engine/types/features.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// How an entry of this size and density is described, all lengths following from its working
// resolution. The resolution is taken from a ladder of steps of sqrt(2), so that entries of like
// size share one and a query is described once for all of them. `voxel_m` and `radius_m` override.
FeatureOptions derive_feature_options(const CloudScale& scale,
                                      EntryKind kind,
                                      KeypointMethod keypoints,
                                      std::optional<double> voxel_m = std::nullopt,
                                      std::optional<double> radius_m = std::nullopt);

// The detector's settings for an entry, or for the query that is matched against it.
KeypointOptions keypoint_options(const FeatureOptions& options);

// Keypoints at the usual spacing, or where these are fewer than `few` at half of that: of what
// shows little each keypoint is another chance.
Keypoints detect_enough(const PreparedCloud& cloud,
                        const FeatureOptions& features,
                        std::size_t few,
                        const RunContext& context);

}  // namespace landmarkdb
