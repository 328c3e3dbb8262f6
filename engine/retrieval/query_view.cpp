#include "engine/retrieval/query_view.hpp"

#include <algorithm>
#include <numbers>
#include <span>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/cloud/join_clouds.hpp"
#include "engine/cloud/prepare_cloud.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/cloud/voxel_cells.hpp"
#include "engine/features/describe_shot.hpp"
#include "engine/features/detect_keypoints.hpp"
#include "engine/features/range_noise.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/feature_options.hpp"

namespace landmarkdb {

namespace {

// One degree: 9 cm at 5 m, and coarse enough that a thinned frame or a 16-line laser still fills
// its rows.
constexpr double kSightStepRad = std::numbers::pi / 180.0;
constexpr std::size_t kTestPoints = 512;
constexpr std::size_t kSamplePoints = 4000;
// Of the noise, where it was laid flat. Far points are few, and tell one bay of a hall from the
// next: with 1.0 the right pose of 126 frames in four halls came first in 98, with 0.3 in 107, with
// this in 110, with none left in 108.
constexpr float kLeftOfNoise = 0.12F;
constexpr std::size_t kLayouts = 2;  // which way furniture faces may outweigh a glimpse of a wall
// Keypoints of one view: a whole turn of a 64-line laser has 14,000, and each costs 1.4 KB and its
// proposals.
constexpr std::size_t kMostKeypoints = 15'000;

Keypoints spread_keypoints(const Keypoints& keypoints) {
  if (keypoints.size() <= kMostKeypoints) return keypoints;
  Keypoints kept;
  for (const std::uint32_t i : spread(keypoints.size(), kMostKeypoints)) {
    kept.index.push_back(keypoints.index[i]);
  }
  return kept;
}

// About `count` indices at even steps of the weights' sum.
std::vector<std::uint32_t> spread_by(std::span<const float> weights, std::size_t count) {
  double sum = 0.0;
  for (const float weight : weights) sum += static_cast<double>(weight);
  const double step = std::max(sum / static_cast<double>(count), 1.0);
  std::vector<std::uint32_t> indices;
  double passed = 0.0;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    passed += static_cast<double>(weights[i]);
    if (passed < step * (static_cast<double>(indices.size()) + 1.0)) continue;
    indices.push_back(i);
  }
  return indices;
}

// Points of the cloud at these indices, with their normals.
void pick(const PreparedCloud& cloud,
          std::span<const std::uint32_t> indices,
          std::vector<Eigen::Vector3f>& points,
          std::vector<Eigen::Vector3f>& normals) {
  points.reserve(indices.size());
  normals.reserve(indices.size());
  for (const std::uint32_t i : indices) {
    points.push_back(cloud.points[i]);
    normals.push_back(cloud.normals[i]);
  }
}

constexpr std::size_t kFewKeypoints = 400;

// Keypoints and descriptors of the prepared cloud.
void describe_view(const FeatureOptions& options,
                   const RunContext& context,
                   StageTimings& timings,
                   QueryView& view) {
  Keypoints keypoints;
  {
    const StageTimer timer(timings.keypoints);
    keypoints = spread_keypoints(detect_enough(view.prepared, options, kFewKeypoints, context));
  }
  const StageTimer timer(timings.describe);
  view.descriptors = describe_shot(view.prepared, keypoints, options.shot_radius_m, context);
}

}  // namespace

std::vector<RangeImage> range_images(const PointCloud& cloud, double finest_step_rad) {
  if (cloud.viewpoint_index.empty()) {
    return {RangeImage(cloud.points, cloud.viewpoints[0], finest_step_rad)};
  }
  const auto seen =
      points_by_viewpoint(cloud.points, cloud.viewpoints.size(), cloud.viewpoint_index);
  std::vector<RangeImage> images;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (!seen[k].empty()) images.emplace_back(seen[k], cloud.viewpoints[k], finest_step_rad);
  }
  return images;
}

CleanQuery clean_query(std::vector<QueryCloud> clouds, const RunContext& context) {
  CloudCounts counts;
  PointCloud cloud = join_clouds(std::move(clouds), counts, context);
  CloudScale scale;
  std::vector<RangeImage> ranges;
  parallel_chunks(2, context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t task = begin; task < end; ++task) {
      if (task == 0 && cloud.size() >= 4) scale = measure_scale(cloud, context);
      if (task == 1) ranges = range_images(cloud, kSightStepRad);
    }
  });
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& point : cloud.points) centre += point.cast<double>();
  if (!cloud.empty()) centre /= static_cast<double>(cloud.size());
  context.check("preprocess");
  return {std::move(cloud), counts, scale, centre, std::move(ranges)};
}

CleanQuery clean_query(const PointCloud& cloud, const RunContext& context) {
  return clean_query(std::vector<QueryCloud>{{cloud}}, context);
}

CleanQuery dense_part(const CleanQuery& query, double spacing_m, const RunContext& context) {
  // A surface through a cell this wide has at least kFewest points where they are dense enough;
  // cells beside such a one are kept whole, so that no edge is cut.
  constexpr double kCellSpacings = 3.2;
  constexpr std::uint32_t kFewest = 10;
  const VoxelCells cells = group_by_voxel(query.cloud.points, kCellSpacings * spacing_m, context);
  std::vector<char> keep(query.cloud.size(), 0);
  const auto mark = [&](const VoxelCell& cell) {
    for (std::uint32_t i = cell.begin; i < cell.end; ++i) keep[cells.order[i]] = 1;
    return false;  // and the next one
  };
  for (const VoxelCell& cell : cells.cells) {
    if (cell.end - cell.begin < kFewest) continue;
    any_around(cells, cell, mark);
  }
  CleanQuery dense;
  const PointCloud& whole = query.cloud;
  dense.cloud.origin = whole.origin;
  dense.cloud.viewpoints = whole.viewpoints;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (keep[i] == 0) continue;
    dense.cloud.points.push_back(whole.points[i]);
    if (!whole.normals.empty()) dense.cloud.normals.push_back(whole.normals[i]);
    if (!whole.viewpoint_index.empty()) {
      dense.cloud.viewpoint_index.push_back(whole.viewpoint_index[i]);
    }
  }
  dense.counts = query.counts;
  dense.scale = query.scale;
  dense.centre = query.centre;
  return dense;
}

QueryView view_for_objects(const CleanQuery& query,
                           const FeatureOptions& options,
                           const RunContext& context,
                           StageTimings& timings) {
  QueryView view;
  {
    const StageTimer timer(timings.preprocess);
    view.prepared = prepare_cloud(
        query.cloud, query.counts, {options.voxel_m, options.normal_radius_m}, context);
    view.noise =
        measure_range_noise(view.prepared, options.normal_radius_m, context, SurfaceShape::kBent);
    pick(view.prepared,
         spread(view.prepared.size(), kSamplePoints),
         view.sample_points,
         view.sample_normals);
  }
  describe_view(options, context, timings, view);
  return view;
}

QueryView view_query(const CleanQuery& query,
                     const FeatureOptions& options,
                     std::uint64_t seed,
                     const RunContext& context,
                     StageTimings& timings) {
  QueryView view;
  {
    const StageTimer timer(timings.preprocess);
    view.prepared = prepare_cloud(
        query.cloud, query.counts, {options.voxel_m, options.normal_radius_m}, context);
    const RangeNoise noise = measure_range_noise(view.prepared, options.normal_radius_m, context);
    pick(view.prepared,
         spread_by(range_weights(view.prepared, noise, 1.0F), kSamplePoints),
         view.precise_points,
         view.precise_normals);
    flatten_range_noise(view.prepared, noise, options.normal_radius_m, context);
    const std::vector<float> weights = range_weights(view.prepared, noise, kLeftOfNoise);
    view.test =
        select_test_points(view.prepared.points, view.prepared.normals, weights, kTestPoints, seed);
    pick(view.prepared, spread_by(weights, kSamplePoints), view.sample_points, view.sample_normals);
  }
  view.planes = lay_out_planes(
      view.prepared.points, view.prepared.normals, plane_bin_m(options.voxel_m), kLayouts);
  describe_view(options, context, timings, view);
  return view;
}

}  // namespace landmarkdb
