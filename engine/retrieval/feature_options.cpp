#include "engine/retrieval/feature_options.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/features/detect_keypoints.hpp"

namespace landmarkdb {

namespace {

// A room of 25 m is described at 5 cm, a table top of 4 m at 2 cm, a street of 70 m at 8 cm: detail
// grows more slowly than extent, because the sensor that asks does not grow with the place.
constexpr double kPlaceVoxelAtOneMetre = 0.01;
// An object must be hundreds of points to have a shape at all: 60 voxels along its diagonal.
constexpr double kObjectVoxelsAcross = 60.0;
constexpr double kVoxelPerSpacing = 1.0;  // finer voxels would mostly be empty
// A depth sensor that moves through a place measures to about a centimetre: finer voxels hold
// noise.
constexpr double kFinestPlaceVoxel = 0.025;
// A depth camera sees some metres of a hall whatever the hall measures.
constexpr double kCoarsestFromExtent = 0.05;
constexpr double kLadderBase = 0.05;        // the ladder's steps are this times a power of sqrt(2)
constexpr double kShotRadiusVoxels = 12.0;  // a descriptor's support; ten at least
constexpr double kNormalRadiusVoxels = 2.5;
constexpr double kKeypointSpacingVoxels = 3.0;
constexpr double kStructureRadiusVoxels = 4.0;

double on_ladder(double voxel_m) {
  const double step = std::round(2.0 * std::log2(voxel_m / kLadderBase));
  return kLadderBase * std::exp2(0.5 * step);
}

}  // namespace

FeatureOptions derive_feature_options(const CloudScale& scale,
                                      EntryKind kind,
                                      KeypointMethod keypoints,
                                      std::optional<double> voxel_m,
                                      std::optional<double> radius_m) {
  const double from_extent =
      kind == EntryKind::kPlace
          ? std::max(
                kFinestPlaceVoxel,
                std::min(kCoarsestFromExtent, kPlaceVoxelAtOneMetre * std::sqrt(scale.extent_m)))
          : scale.extent_m / kObjectVoxelsAcross;
  FeatureOptions options;
  options.voxel_m =
      voxel_m ? *voxel_m : on_ladder(std::max(from_extent, kVoxelPerSpacing * scale.spacing_m));
  options.shot_radius_m = radius_m ? *radius_m : kShotRadiusVoxels * options.voxel_m;
  options.normal_radius_m = kNormalRadiusVoxels * options.voxel_m;
  options.keypoint_spacing_m = kKeypointSpacingVoxels * options.voxel_m;
  options.keypoints = keypoints;
  return options;
}

KeypointOptions keypoint_options(const FeatureOptions& options) {
  KeypointOptions keypoints;
  keypoints.method = options.keypoints;
  keypoints.spacing_m = options.keypoint_spacing_m;
  keypoints.structure_radius_m = kStructureRadiusVoxels * options.voxel_m;
  return keypoints;
}

Keypoints detect_enough(const PreparedCloud& cloud,
                        const FeatureOptions& features,
                        std::size_t few,
                        const RunContext& context) {
  KeypointOptions options = keypoint_options(features);
  Keypoints keypoints = detect_keypoints(cloud, options, context);
  if (keypoints.size() >= few) return keypoints;
  constexpr double kDenser = 0.5;
  options.spacing_m *= kDenser;
  return detect_keypoints(cloud, options, context);
}

}  // namespace landmarkdb
