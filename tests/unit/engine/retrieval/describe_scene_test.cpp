#include "engine/retrieval/describe_scene.hpp"

#include <limits>
#include <set>
#include <stop_token>
#include <string>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using testing::describe;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using testing::small_room;
using testing::SyntheticScene;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The message describe_scene refuses the cloud with.
std::string refusal(const PointCloud& cloud, const IndexOptions& options = {}) {
  try {
    describe("thing", cloud, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

PointCloud plane(std::size_t points) {
  Random random(1);
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.points.emplace_back(
        static_cast<float>(random.uniform(-2, 2)), static_cast<float>(random.uniform(-2, 2)), 1.0F);
  }
  return cloud;
}

TEST(DescribeScene, MakesARecordThatHoldsTogether) {
  const SyntheticScene room = small_room(2);
  IndexOptions options;
  options.up = Eigen::Vector3d(0, 0, 9.81);
  const SceneRecord record = describe("room", room.cloud, options);
  EXPECT_EQ(record.name, "room");
  EXPECT_EQ(record.kind, EntryKind::kPlace);
  EXPECT_EQ(record.sources, (std::vector<std::string>{"room.ply"}));
  ASSERT_TRUE(record.up);
  EXPECT_TRUE(record.up->isApprox(Eigen::Vector3d::UnitZ(), 1e-12)) << "up is made unit";
  EXPECT_TRUE(record.warnings.empty()) << ::testing::PrintToString(record.warnings);

  EXPECT_EQ(record.prepared.resolution_m, record.options.voxel_m);
  EXPECT_EQ(record.prepared.normals.size(), record.prepared.size());
  EXPECT_TRUE(record.prepared.normals_from_viewpoint);
  EXPECT_EQ(record.prepared.counts.points, room.cloud.size());
  EXPECT_LT(record.prepared.size(), room.cloud.size());
  for (const Eigen::Vector3f& n : record.prepared.normals) ASSERT_NEAR(n.norm(), 1.0F, 1e-4F);

  const DescriptorSet& set = record.descriptors;
  EXPECT_GT(set.size(), 100U);
  EXPECT_EQ(set.frames.size(), set.size());
  EXPECT_EQ(set.normals.size(), set.size());
  EXPECT_EQ(set.values.size(), set.size() * kShotLength);
  for (std::size_t i = 0; i < set.size(); i += 17) {
    double squares = 0.0;
    for (const float v : set.row(i)) squares += static_cast<double>(v) * v;
    EXPECT_NEAR(squares, 1.0, 1e-3);
  }
}

TEST(DescribeScene, IsTheSameForAnyNumberOfThreads) {
  const SyntheticScene room = small_room(2);
  const auto described = [&](int threads) {
    std::vector<Scan> scans(1);
    scans[0].cloud = room.cloud;
    RunContext context;
    context.threads = threads;
    return describe_scene("room", std::move(scans), {}, context);
  };
  const SceneRecord one = described(1);
  const SceneRecord three = described(3);
  EXPECT_EQ(one.prepared.points, three.prepared.points);
  EXPECT_EQ(one.prepared.normals, three.prepared.normals);
  EXPECT_EQ(one.descriptors.values, three.descriptors.values);
}

TEST(DescribeScene, LaysSeveralScansIntoOneFrame) {
  const SyntheticScene room = small_room(2);
  // Each station's scan in a frame of its own, as files have them.
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < room.scans.size(); ++i) {
    Scan scan;
    scan.T_scene_cloud = testing::look_at({1.0 + static_cast<double>(i), 2, 1}, {0, 0, 0});
    scan.cloud = testing::moved(room.scans[i], scan.T_scene_cloud.inverse());
    scan.source = "scan" + std::to_string(i) + ".pcd";
    scans.push_back(std::move(scan));
  }
  scans.push_back({PointCloud{}, Eigen::Isometry3d::Identity(), "empty.pcd"});
  const SceneRecord merged = describe_scene("room", std::move(scans), {}, {});
  const SceneRecord whole = describe("room", room.cloud, {});
  EXPECT_EQ(merged.sources.size(), 4U);
  EXPECT_EQ(merged.prepared.counts.points, room.cloud.size());
  EXPECT_NEAR(static_cast<double>(merged.prepared.size()),
              static_cast<double>(whole.prepared.size()),
              0.02 * static_cast<double>(whole.prepared.size()));
  EXPECT_TRUE(merged.prepared.normals_from_viewpoint);
  for (const Eigen::Vector3f& p : merged.prepared.points) {
    const Eigen::Vector3d q = p.cast<double>() + merged.prepared.origin;
    ASSERT_TRUE((q.array() > -0.1).all() && (q.array() < room.room_m.array() + 0.1).all());
  }
}

TEST(DescribeScene, RefusesWhatHoldsTooFewPointsAndSaysHowMany) {
  PointCloud cloud;
  EXPECT_THAT(refusal(cloud), HasSubstr("0 points"));
  for (int n = 1; n <= 3; ++n) {
    cloud.points.emplace_back(static_cast<float>(n), 0.0F, static_cast<float>(n * n));
    EXPECT_THAT(refusal(cloud), AllOf(HasSubstr(std::to_string(n)), HasSubstr("at least 4")));
  }
  PointCloud repeated;
  repeated.points.assign(50, Eigen::Vector3f(1, 2, 3));
  EXPECT_THAT(refusal(repeated), AllOf(HasSubstr("49 repeated"), HasSubstr("1 left")));
  PointCloud not_finite;
  not_finite.points.assign(50, Eigen::Vector3f(kNan, 2, 3));
  EXPECT_THAT(refusal(not_finite), HasSubstr("50 not finite"));
  EXPECT_THROW(describe_scene("no scans", std::vector<Scan>{}, {}, {}), Error);
}

TEST(DescribeScene, RefusesAPlaneALineAndASpeck) {
  EXPECT_THAT(refusal(plane(20'000)), HasSubstr("plane"));
  PointCloud line;
  for (int i = 0; i < 1000; ++i) line.points.emplace_back(0.01F * static_cast<float>(i), 0, 1);
  EXPECT_NE(refusal(line), "");
  PointCloud four;
  four.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_NE(refusal(four), "");
}

TEST(DescribeScene, RefusesLengthsThatAreNone) {
  const PointCloud cloud = plane(100);
  for (const double bad : {0.0, -0.05, std::nan(""), std::numeric_limits<double>::infinity()}) {
    IndexOptions options;
    options.voxel_m = bad;
    EXPECT_THAT(refusal(cloud, options), HasSubstr("voxel"));
    options = {};
    options.radius_m = bad;
    EXPECT_THAT(refusal(cloud, options), HasSubstr("radius"));
  }
  IndexOptions options;
  options.up = Eigen::Vector3d::Zero();
  EXPECT_THAT(refusal(cloud, options), HasSubstr("up"));
  options.up = Eigen::Vector3d(0, 0, std::nan(""));
  EXPECT_THAT(refusal(cloud, options), HasSubstr("up"));
}

TEST(DescribeScene, RefusesAVoxelThatLeavesNothingOfTheCloud) {
  const SyntheticScene room = small_room(2);
  IndexOptions options;
  options.voxel_m = 500.0;
  EXPECT_NE(refusal(room.cloud, options), "");
}

TEST(DescribeScene, WarnsOfUnitsThatAreNotMetres) {
  const SyntheticScene room = small_room(2);
  PointCloud millimetres = room.cloud;
  for (Eigen::Vector3f& p : millimetres.points) p *= 1000.0F;
  for (Eigen::Vector3f& v : millimetres.viewpoints) v *= 1000.0F;
  EXPECT_THAT(describe("mm", millimetres, {}).warnings, Contains("units_suspect"));
  EXPECT_THAT(describe("m", room.cloud, {}).warnings, Not(Contains("units_suspect")));
}

TEST(DescribeScene, SaysWhenNothingTellsWhichSideASurfaceIsSeenFrom) {
  SyntheticScene room = small_room(2);
  room.cloud.viewpoints.clear();
  room.cloud.viewpoint_index.clear();
  EXPECT_THAT(describe("room", room.cloud, {}).warnings, Contains("normals_unoriented"));
}

TEST(DescribeScene, ReportsItsStagesAndStopsWhenTold) {
  const SyntheticScene room = small_room(2);
  const auto scans = [&] {
    std::vector<Scan> made(1);
    made[0].cloud = room.cloud;
    return made;
  };
  std::set<std::string> stages;
  RunContext context;
  context.progress = [&](const Progress& progress) { stages.emplace(progress.stage); };
  describe_scene("room", scans(), {}, context);
  EXPECT_THAT(stages, IsSupersetOf({"sanitise", "prepare", "keypoints", "describe"}));

  for (const std::string stage : {"sanitise", "prepare", "keypoints", "describe"}) {
    std::stop_source stop;
    context.stop = stop.get_token();
    context.progress = [&](const Progress& progress) {
      if (progress.stage == stage) stop.request_stop();
    };
    try {
      describe_scene("room", scans(), {}, context);
      ADD_FAILURE() << "ran on after " << stage;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled);
    }
  }
}

TEST(EstimateIndex, ForetellsWhatIndexingThenMakes) {
  const SyntheticScene room = small_room(2);
  std::vector<Scan> scans(1);
  scans[0].cloud = room.cloud;
  const IndexEstimate estimate = estimate_index(std::move(scans), {}, {});
  const SceneRecord record = describe("room", room.cloud, {});
  EXPECT_EQ(estimate.options, record.options);
  EXPECT_EQ(estimate.points, room.cloud.size());
  EXPECT_EQ(estimate.points_used, record.prepared.size());
  EXPECT_EQ(estimate.keypoints, record.descriptors.size() + record.descriptors.dropped);
  EXPECT_GT(estimate.database_bytes, record.descriptors.values.size() * sizeof(float));
  EXPECT_GT(estimate.memory_bytes, estimate.database_bytes);
  EXPECT_GT(estimate.seconds, 0.0);
}

// It used to take memory until there was none.
TEST(DescribeScene, RefusesAVoxelWhoseGridNobodyCouldHoldAndSoDoesTheEstimate) {
  const SyntheticScene room = small_room(2);
  IndexOptions options;
  options.voxel_m = 1e-6;
  const auto scans = [&] {
    std::vector<Scan> made(1);
    made[0].cloud = room.cloud;
    return made;
  };
  for (const bool estimate : {false, true}) {
    try {
      if (estimate) {
        estimate_index(scans(), options, {});
      } else {
        describe_scene("room", scans(), options, {});
      }
      ADD_FAILURE() << "taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_EQ(error.field(), "voxel");
      EXPECT_THAT(error.what(), ::testing::HasSubstr("cells, the limit is"));
    }
  }
}

TEST(EstimateIndex, CountsTheGridOfAFineVoxel) {
  const SyntheticScene room = small_room(2);
  const auto served = [&](double voxel_m) {
    std::vector<Scan> scans(1);
    scans[0].cloud = room.cloud;
    IndexOptions options;
    options.voxel_m = voxel_m;
    return estimate_index(std::move(scans), options, {}).served_bytes;
  };
  EXPECT_GT(served(0.005), room.cloud.size() * 2048) << "a block and more a point";
  EXPECT_LT(served(0.2), served(0.005) / 10);
}

}  // namespace
}  // namespace landmarkdb
