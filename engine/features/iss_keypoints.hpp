#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

struct IssOptions {
  double salient_radius_m = 0.0;  // of the scatter matrix; 6 resolutions is usual
  double nms_radius_m = 0.0;      // a keypoint is the most salient within it; 4 resolutions
  double max_ratio_21 = 0.975;    // second to first eigenvalue, below it: PCL's default
  double max_ratio_32 = 0.975;    // third to second
  std::size_t min_neighbours = 5;
};

// Intrinsic shape signatures (Zhong 2009): points whose three scatter eigenvalues differ and whose
// smallest is a local maximum. Indices ascend.
//
// Ours and not PCL 1.13's: that one skips points whose smallest eigenvalue rounds below zero (every
// flat wall) with a printed warning each, and then reads what it never wrote for them.
Keypoints iss_keypoints(const PreparedCloud& cloud,
                        const IssOptions& options,
                        const RunContext& context);

}  // namespace landmarkdb
