#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Normal aligned radial features (Steder 2010) by PCL, one range image a viewpoint, each interest
// point mapped to the nearest point of the cloud. `support_m`: the size of the surface patch that
// one interest point stands for. Indices ascend and do not repeat; none found is an empty result.
//
// Looks at `context` between viewpoints: PCL cannot be stopped within an image, whose size is
// bounded (700,000 pixels, some seconds). Without a viewpoint the cloud's zero is taken; a cloud's
// `viewpoint_index` past its viewpoints is Error{kInvalidArgument}.
Keypoints narf_keypoints(const PreparedCloud& cloud, double support_m, const RunContext& context);

}  // namespace landmarkdb
