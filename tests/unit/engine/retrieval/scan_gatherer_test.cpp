#include "engine/retrieval/scan_gatherer.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using testing::small_room;
using testing::SyntheticScene;

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

// Points `begin` .. `end` of the cloud.
PointCloud part(const PointCloud& cloud, std::size_t begin, std::size_t end) {
  PointCloud block;
  const auto of = [&](const auto& values) {
    using Values = std::decay_t<decltype(values)>;
    if (values.empty()) return Values{};
    return Values(values.begin() + static_cast<std::ptrdiff_t>(begin),
                  values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  block.points = of(cloud.points);
  block.normals = of(cloud.normals);
  block.colours = of(cloud.colours);
  block.viewpoint_index = of(cloud.viewpoint_index);
  block.viewpoints = cloud.viewpoints;
  block.origin = cloud.origin;
  return block;
}

// Each of the scans in blocks, gathered in the memory of `most_held` points.
GatheredScans gather(const std::vector<PointCloud>& scans,
                     std::size_t most_held,
                     const IndexOptions& options = {},
                     const RunContext& context = {}) {
  ScanGatherer gatherer(options, context, most_held);
  const std::size_t step = std::min<std::size_t>(gatherer.block_points(), 1'000'000);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    gatherer.begin_scan("scan" + std::to_string(s), Eigen::Isometry3d::Identity());
    for (std::size_t at = 0; at < scans[s].size(); at += step) {
      gatherer.add(part(scans[s], at, std::min(at + step, scans[s].size())));
    }
  }
  return gatherer.finish();
}

std::size_t total_weight(const PointCloud& cloud) {
  return std::accumulate(cloud.weights.begin(), cloud.weights.end(), std::size_t{0});
}

// The room, each point four times give or take half a millimetre: dense enough to be condensed.
std::vector<PointCloud> dense_scans(const SyntheticScene& room) {
  Random random(3);
  std::vector<PointCloud> scans;
  for (const PointCloud& scan : room.scans) {
    PointCloud dense = scan;
    for (int copy = 0; copy < 3; ++copy) {
      for (const Eigen::Vector3f& p : scan.points) {
        const Eigen::Vector3d off =
            5e-4 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
        dense.points.push_back(p + off.cast<float>());
      }
    }
    dense.normals.clear();
    dense.colours.clear();
    if (!dense.viewpoint_index.empty()) {
      dense.viewpoint_index.resize(dense.size(), scan.viewpoint_index[0]);
    }
    scans.push_back(std::move(dense));
  }
  return scans;
}

std::size_t size_of(const std::vector<PointCloud>& scans) {
  std::size_t size = 0;
  for (const PointCloud& scan : scans) size += scan.size();
  return size;
}

TEST(ScanGatherer, HoldsScansAsTheyAreUpToItsBound) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  const GatheredScans whole = gather(scans, kAll - 1);
  const GatheredScans just = gather(scans, size_of(scans));
  EXPECT_EQ(just.cell_m, 0.0);
  EXPECT_TRUE(just.cloud.weights.empty());
  EXPECT_EQ(just.cloud.points, whole.cloud.points);
  EXPECT_EQ(just.cloud.viewpoint_index, whole.cloud.viewpoint_index);
  EXPECT_GT(gather(scans, size_of(scans) - 1).cell_m, 0.0) << "one more is too many";
}

TEST(ScanGatherer, HoldsNoMoreThanItsBoundAndDescribesTheSame) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  const GatheredScans whole = gather(scans, kAll - 1);
  IndexOptions options;
  options.voxel_m = 0.16;  // some thousand voxels: their cells fit
  for (const std::size_t share : {2U, 3U}) {
    const std::size_t most = size_of(scans) / share;
    GatheredScans few = gather(scans, most, options);
    EXPECT_GT(few.cell_m, 0.0);
    EXPECT_LE(few.cloud.size(), most + most / 8 + 1);
    EXPECT_EQ(total_weight(few.cloud), few.counts.used);
    EXPECT_EQ(few.counts.points, whole.counts.points);
    EXPECT_EQ(few.counts.used, whole.counts.used);
    EXPECT_EQ(few.sources, whole.sources);
    ASSERT_EQ(few.cloud.viewpoints.size(), whole.cloud.viewpoints.size());

    const SceneRecord want = describe_scene("whole", whole, options, {});
    const SceneRecord got = describe_scene("few", std::move(few), options, {});
    EXPECT_EQ(got.options.voxel_m, want.options.voxel_m);
    ASSERT_EQ(got.prepared.size(), want.prepared.size());
    EXPECT_EQ(got.prepared.viewpoint_index, want.prepared.viewpoint_index);
    for (std::size_t i = 0; i < got.prepared.size(); ++i) {
      ASSERT_LT((got.prepared.points[i] - want.prepared.points[i]).norm(), 1e-5F);
    }
    EXPECT_EQ(got.descriptors.size(), want.descriptors.size());
  }
}

TEST(ScanGatherer, LeavesTheWorkingResolutionWhatItIs) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  const CloudScale whole = measure_scale(gather(scans, kAll - 1).cloud);
  const CloudScale few = measure_scale(gather(scans, size_of(scans) / 3).cloud);
  EXPECT_NEAR(few.extent_m, whole.extent_m, 0.02);
  EXPECT_NEAR(few.spacing_m, whole.spacing_m, 0.1 * whole.spacing_m);
}

TEST(ScanGatherer, TakesOneScanLargerThanItsBound) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  const GatheredScans few = gather({scans[0]}, scans[0].size() / 3);
  EXPECT_EQ(few.counts.points, scans[0].size());
  EXPECT_EQ(total_weight(few.cloud), scans[0].size());
  EXPECT_LT(few.cloud.size(), scans[0].size() / 2);
  EXPECT_TRUE(few.cloud.viewpoint_index.empty()) << "one viewpoint only";
}

RunContext on_threads(int threads) {
  RunContext context;
  context.threads = threads;
  return context;
}

TEST(ScanGatherer, GivesTheSameOnAnyNumberOfThreads) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  const std::size_t most = size_of(scans) / 3;
  const GatheredScans one = gather(scans, most, {}, on_threads(1));
  const GatheredScans three = gather(scans, most, {}, on_threads(3));
  EXPECT_EQ(one.cloud.points, three.cloud.points);
  EXPECT_EQ(one.cloud.weights, three.cloud.weights);
  EXPECT_EQ(one.cloud.viewpoint_index, three.cloud.viewpoint_index);
}

TEST(ScanGatherer, DropsFarPointsInTheFirstBlockAndTheLast) {
  std::vector<PointCloud> scans = dense_scans(small_room(2));
  scans[0].points[5] = {1e9F, 0, 0};
  scans[0].points[6].x() = std::numeric_limits<float>::quiet_NaN();
  scans.back().points.back() = {0, -3e7F, 1e30F};
  const GatheredScans few = gather(scans, size_of(scans) / 3);
  EXPECT_EQ(few.counts.out_of_range, 2U);
  EXPECT_EQ(few.counts.not_finite, 1U);
  EXPECT_EQ(few.counts.used + 3, few.counts.points);
  for (const Eigen::Vector3f& p : few.cloud.points) ASSERT_LT(p.cwiseAbs().maxCoeff(), 100.0F);
}

TEST(ScanGatherer, HoldsALargeSurfaceInHalvesOfItsVoxel) {
  // Ten thousand voxels and more, where a thousand points shall be held.
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  IndexOptions options;
  options.voxel_m = 0.04;
  const GatheredScans few = gather(scans, 1000, options);
  EXPECT_DOUBLE_EQ(few.cell_m, 0.02);
  EXPECT_EQ(total_weight(few.cloud), size_of(scans));
}

TEST(ScanGatherer, RefusesWhereTheCellsTurnOutTooCoarse) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  GatheredScans few = gather(scans, 1000);
  few.cell_m = 0.05;
  IndexOptions options;
  options.voxel_m = 0.05;
  try {
    describe_scene("room", std::move(few), options, {});
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("--voxel"));
  }
}

TEST(ScanGatherer, KeepsNormalsAndMendsTheFewThatAreBad) {
  std::vector<PointCloud> scans = dense_scans(small_room(2));
  for (PointCloud& scan : scans) scan.normals.assign(scan.size(), {0, 0, 1});
  for (std::size_t i = 0; i < scans[0].size(); i += 50) scans[0].normals[i].setZero();
  GatheredScans few = gather(scans, size_of(scans) / 3);
  ASSERT_EQ(few.cloud.normals.size(), few.cloud.size());
  for (const Eigen::Vector3f& n : few.cloud.normals) ASSERT_EQ(n, Eigen::Vector3f(0, 0, 1));
  scans.back().normals.clear();
  EXPECT_TRUE(gather(scans, size_of(scans) / 3).cloud.normals.empty());
}

TEST(ScanGatherer, StopsWhenTold) {
  const std::vector<PointCloud> scans = dense_scans(small_room(2));
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  const IndexOptions options;
  ScanGatherer gatherer(options, context, 5000);
  gatherer.begin_scan("scan", Eigen::Isometry3d::Identity());
  gatherer.add(part(scans[0], 0, 6000));
  stop.request_stop();
  EXPECT_THROW(gatherer.add(part(scans[0], 6000, 7000)), Error);
}

TEST(ScanGatherer, SaysWhatBecameOfPointsThatAreAllOfNoUse) {
  PointCloud cloud;
  cloud.points.assign(100, Eigen::Vector3f(1, 2, std::numeric_limits<float>::infinity()));
  cloud.points[7].setZero();
  for (const std::size_t most : {std::size_t{10}, kAll - 1}) {
    try {
      gather({cloud}, most);
      ADD_FAILURE() << "taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_THAT(error.what(), ::testing::HasSubstr("100 points, 99 not finite, 0 repeated"));
    }
  }
}

}  // namespace
}  // namespace landmarkdb
