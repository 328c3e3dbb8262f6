#include "bench/micro/shot_cloud.hpp"

#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "engine/cloud/prepare_cloud.hpp"
#include "engine/cloud/sanitise.hpp"
#include "engine/features/detect_keypoints.hpp"

namespace landmarkdb::bench {

ShotCloud make_shot_cloud(std::size_t scan_points, std::size_t keypoints, std::uint64_t seed) {
  // What the indexer derives for a lobby of this size.
  constexpr double kVoxel_m = 0.05;
  constexpr double kNormalRadius_m = 0.125;
  constexpr double kSpacing_m = 0.15;
  const RunContext context;
  datasets::PlaceOptions place;
  place.seed = seed;
  datasets::ScannerOptions scanner;
  scanner.points = scan_points;
  scanner.seed = seed;
  PointCloud scan =
      datasets::merge_stations(datasets::scan_place(datasets::make_place(place), scanner, context));
  const CloudCounts counts = sanitise(scan, context);
  ShotCloud result;
  result.cloud = prepare_cloud(scan, counts, {kVoxel_m, kNormalRadius_m}, context);
  KeypointOptions options;
  options.spacing_m = kSpacing_m;
  options.structure_radius_m = kNormalRadius_m;
  const Keypoints all = detect_keypoints(result.cloud, options, context);
  const std::size_t count = keypoints == 0 ? all.size() : std::min(keypoints, all.size());
  for (std::size_t i = 0; i < count; ++i) {
    result.keypoints.index.push_back(all.index[i * all.size() / count]);
  }
  return result;
}

}  // namespace landmarkdb::bench
