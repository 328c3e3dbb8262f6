#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

enum class ShotMethod {
  kFast,  // ours; rows equal PCL's within 1e-4 but for points on the rim of a bin
  kPcl,   // the reference, some ten times slower
};

// Describes each keypoint by SHOT (Tombari, Salti, Di Stefano 2010) and its local reference frame,
// both over the points nearer than `radius_m`.
//
// Rows come in the order of `keypoints`; a keypoint with fewer than five other points in reach, or
// whose frame or histogram is not finite, has no row and is counted in `dropped`. `values` are unit
// length, frames are exact rotations R_cloud_lrf (right-handed, orthonormal to float rounding).
//
// The same bytes for any `context.threads`. Reports the stage "describe" in keypoints; a stop or a
// deadline is noticed within a few dozen descriptors. Throws Error{kInvalidArgument} when a point
// or normal is not finite, there is not one normal a point, a keypoint points outside the cloud, or
// the radius is not positive and finite. Cost: about the number of neighbours of all keypoints
// together.
DescriptorSet describe_shot(const PreparedCloud& cloud,
                            const Keypoints& keypoints,
                            double radius_m,
                            const RunContext& context,
                            ShotMethod method = ShotMethod::kFast);

}  // namespace landmarkdb
