#include "engine/retrieval/describe_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/cloud/prepare_cloud.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/features/describe_shot.hpp"
#include "engine/features/detect_keypoints.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/feature_options.hpp"

namespace landmarkdb {

namespace {

GatheredScans gather(std::vector<Scan> scans,
                     const IndexOptions& options,
                     const RunContext& context) {
  ScanGatherer gatherer(options, context);
  for (Scan& scan : scans) {
    gatherer.begin_scan(std::move(scan.source), scan.T_scene_cloud);
    gatherer.add(std::exchange(scan.cloud, {}));
  }
  return gatherer.finish();
}

FeatureOptions feature_options_of(const CloudScale& scale, const IndexOptions& options) {
  for (const auto& [name, value] :
       {std::pair{"voxel", options.voxel_m}, {"radius", options.radius_m}}) {
    if (value && !(*value > 0.0 && std::isfinite(*value))) {
      throw Error(
          ErrorCode::kInvalidArgument,
          std::string(name) + " is " + std::to_string(*value) + " m, want a positive length",
          name);
    }
  }
  return derive_feature_options(
      scale, options.kind, options.keypoints, options.voxel_m, options.radius_m);
}

// The cells are those of the working resolution as it looked when they were needed. A step of its
// ladder less would be as good; scans whose later part is much smaller than the first are rare.
void check_cells(double cell_m, double voxel_m) {
  constexpr double kFewestAcross = 1.4;  // in a voxel
  if (kFewestAcross * cell_m <= voxel_m) return;
  std::ostringstream text;
  text << "the scans have more points than are held in memory and were condensed to cells of "
       << cell_m << " m, too coarse for their working resolution of " << voxel_m
       << " m: give it with the scans (--voxel), or thin them before";
  throw Error(ErrorCode::kResourceExhausted, text.str(), "voxel");
}

PrepareOptions prepare_options(const FeatureOptions& features) {
  return {.voxel_m = features.voxel_m,
          .normal_radius_m = features.normal_radius_m,
          .without_strays = true};
}

// The front of a head from one frame has 44 at the usual spacing, a toy 500.
constexpr std::size_t kFewOfObject = 150;

Keypoints keypoints_of(const PreparedCloud& cloud,
                       const FeatureOptions& features,
                       EntryKind kind,
                       const RunContext& context) {
  return kind == EntryKind::kObject ? detect_enough(cloud, features, kFewOfObject, context)
                                    : detect_keypoints(cloud, keypoint_options(features), context);
}

std::optional<Eigen::Vector3d> unit_up(const std::optional<Eigen::Vector3d>& up) {
  if (!up) return std::nullopt;
  if (!up->allFinite() || !(up->norm() > 0.0)) {
    throw Error(
        ErrorCode::kInvalidArgument, "the up direction must be finite and longer than zero", "up");
  }
  return up->stableNormalized();
}

}  // namespace

SceneRecord describe_scene(std::string name,
                           GatheredScans scans,
                           const IndexOptions& options,
                           const RunContext& context) {
  SceneRecord record;
  record.name = std::move(name);
  record.kind = options.kind;
  record.up = unit_up(options.up);
  record.sources = std::move(scans.sources);

  const CloudScale scale = measure_scale(scans.cloud, context);
  if (units_look_wrong(scale, options.kind)) record.warnings.emplace_back("units_suspect");
  record.options = feature_options_of(scale, options);
  check_cells(scans.cell_m, record.options.voxel_m);
  grid_size(
      scans.cloud.points, record.options.voxel_m, context);  // refuses what no server could hold

  context.report("prepare", 0, 1);
  record.prepared =
      prepare_cloud(scans.cloud, scans.counts, prepare_options(record.options), context);
  scans = {};
  if (!record.prepared.normals_from_viewpoint) record.warnings.emplace_back("normals_unoriented");

  const Keypoints keypoints = keypoints_of(record.prepared, record.options, options.kind, context);
  record.descriptors =
      describe_shot(record.prepared, keypoints, record.options.shot_radius_m, context);
  if (record.descriptors.size() < 4) {
    throw Error(ErrorCode::kInvalidArgument,
                "nothing to recognise '" + record.name +
                    "' by: " + describe_counts(record.prepared.counts) + ", " +
                    std::to_string(record.prepared.size()) + " at the working resolution, " +
                    std::to_string(keypoints.size()) + " keypoints, " +
                    std::to_string(record.descriptors.size()) +
                    " descriptors, want at least 4: is it all one plane?");
  }
  return record;
}

SceneRecord describe_scene(std::string name,
                           std::vector<Scan> scans,
                           const IndexOptions& options,
                           const RunContext& context) {
  return describe_scene(
      std::move(name), gather(std::move(scans), options, context), options, context);
}

IndexEstimate estimate_index(std::vector<Scan> scans,
                             const IndexOptions& options,
                             const RunContext& context) {
  return estimate_index(gather(std::move(scans), options, context), options, context);
}

IndexEstimate estimate_index(GatheredScans scans,
                             const IndexOptions& options,
                             const RunContext& context) {
  const auto start = std::chrono::steady_clock::now();
  IndexEstimate estimate;
  estimate.points = scans.counts.points;
  estimate.options = feature_options_of(measure_scale(scans.cloud, context), options);
  check_cells(scans.cell_m, estimate.options.voxel_m);
  const GridSize grid = grid_size(scans.cloud.points, estimate.options.voxel_m, context);
  const PreparedCloud prepared =
      prepare_cloud(scans.cloud, scans.counts, prepare_options(estimate.options), context);
  estimate.points_used = prepared.size();
  const Keypoints keypoints = keypoints_of(prepared, estimate.options, options.kind, context);
  estimate.keypoints = keypoints.size();
  const std::chrono::duration<double> so_far = std::chrono::steady_clock::now() - start;

  // Bytes as the store lays them out: points and normals as float, a quaternion and the descriptor
  // a keypoint.
  constexpr std::uint64_t kPointBytes = 24;
  constexpr std::uint64_t kKeypointBytes = 24 + 16 + kShotLength * sizeof(float);
  estimate.database_bytes =
      kPointBytes * estimate.points_used + kKeypointBytes * estimate.keypoints;
  // Of each point that is held: 12 to 33 bytes, and as many again where scans are merged or sorted.
  constexpr std::uint64_t kHeldBytes = 64;
  const std::uint64_t held =
      scans.cell_m > 0.0 ? std::max(ScanGatherer::kMostHeld, scans.cloud.size()) : estimate.points;
  estimate.memory_bytes = kHeldBytes * held + 4 * estimate.database_bytes;
  estimate.served_bytes = 2 * estimate.database_bytes + grid.bytes();
  // A sample of the descriptors tells what the rest will take.
  constexpr std::size_t kSample = 200;
  Keypoints sample;
  const std::size_t step = std::max<std::size_t>(1, keypoints.size() / kSample);
  for (std::size_t i = 0; i < keypoints.size(); i += step)
    sample.index.push_back(keypoints.index[i]);
  const auto described_from = std::chrono::steady_clock::now();
  describe_shot(prepared, sample, estimate.options.shot_radius_m, context);
  const std::chrono::duration<double> sampled = std::chrono::steady_clock::now() - described_from;
  estimate.seconds = so_far.count() + sampled.count() * static_cast<double>(step);
  return estimate;
}

}  // namespace landmarkdb
