#pragma once

#include <cstdint>

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

struct KeypointOptions {
  KeypointMethod method = KeypointMethod::kStructure;
  // kUniform, kStructure: one keypoint a voxel of this edge. kIss, kNarf: unused.
  double spacing_m = 0.0;
  // kStructure: the ball over which normals must spread. kNarf: the support of an interest point.
  double structure_radius_m = 0.0;
  // kStructure: least second eigenvalue of mean(n n^T), 0 (one plane) .. 1/2. Measured: 3.5x fewer
  // descriptors at the same success of pose.
  double min_structure = 0.05;
};

// Chooses the points of a prepared cloud that are worth a description. Indices ascend and do not
// repeat; none found is an empty result.
//
// kUniform: of each voxel the point nearest its centre. kStructure: of those the ones around which
// the surface bends. kIss: intrinsic shape signatures (Zhong 2009), radii 6 and 4 times the
// cloud's resolution. kNarf: normal aligned radial features (Steder 2010; PCL) on range images
// taken from the cloud's viewpoints, each interest point mapped to the nearest point of the cloud;
// without a viewpoint the cloud's zero is taken.
//
// The same result for any `context.threads`. Reports the stage "keypoints". Throws
// Error{kInvalidArgument} for options that cannot be, points or normals that are not finite, or a
// voxel so small that the cloud spans more than 2^21 of them. Thread-safe.
Keypoints detect_keypoints(const PreparedCloud& cloud,
                           const KeypointOptions& options,
                           const RunContext& context);

}  // namespace landmarkdb
