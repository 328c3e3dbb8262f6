#include "engine/retrieval/assess.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::Surface;

// A corner as a place, and as seen from a sensor in it: what is asked and the pose that is right.
struct Seen {
  Surface corner = testing::corner_room(0.03);
  Eigen::Isometry3d T_entry_sensor = [] {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = rotation_from_vector({0.3, -0.2, 2.0});
    T.translation() = Eigen::Vector3d(2.5, 2.4, 2.0);
    return T;
  }();
  Surface here = testing::corner_room(0.04, 2).seen_from(T_entry_sensor);
  Entry entry = [this] {
    auto record = std::make_shared<SceneRecord>();
    record->prepared.points = corner.points;
    record->prepared.normals = corner.normals;
    record->prepared.resolution_m = 0.05;
    CatalogEntry stored;
    stored.record = std::move(record);
    return make_entry(std::move(stored));
  }();
  CleanQuery query = [this] {
    PointCloud cloud;
    cloud.points = here.points;
    return clean_query(std::move(cloud));
  }();
  Meeting meeting{entry.grid, here.points, here.normals, false, 0.0};

  Assessed assess(const Eigen::Isometry3d& start) const {
    Assessed assessed = assess_coarse(meeting, entry, query, start);
    assess_fine(meeting, entry, query, assessed);
    assess_precisely(meeting, entry, query, assessed);
    return assessed;
  }
};

TEST(Assess, RefinesTheRightPoseAndFindsItGood) {
  const Seen seen;
  Eigen::Isometry3d start = seen.T_entry_sensor;
  start.translation() += Eigen::Vector3d(0.04, -0.03, 0.03);
  const Assessed coarse = assess_coarse(seen.meeting, seen.entry, seen.query, start);
  EXPECT_THAT(coarse.T_entry_sensor, PoseNear(seen.T_entry_sensor, 0.02, 0.02));
  EXPECT_EQ(coarse.T_entry_proposed.matrix(), start.matrix());
  EXPECT_GT(coarse.score, 0.8);
  const Assessed fine = seen.assess(start);
  EXPECT_THAT(fine.T_entry_sensor, PoseNear(seen.T_entry_sensor, 0.005, 0.004));
  EXPECT_GT(fine.score, 0.7);
  EXPECT_LE(fine.score, 1.0);
  EXPECT_GT(fine.evidence.overlap, 0.95);
  EXPECT_GT(fine.evidence.explained, 0.9);
  EXPECT_LT(fine.evidence.crossed, 0.05);
  EXPECT_GT(fine.evidence.observability, 0.01);
}

// The points that the score goes by lie 2 cm off, as if rounded by laying noise flat.
TEST(Assess, EndsOnThePrecisePoints) {
  Seen seen;
  std::vector<Eigen::Vector3f> off = seen.here.points;
  for (std::size_t i = 0; i < off.size(); ++i) off[i] += 0.02F * seen.here.normals[i];
  seen.meeting.source = off;
  const Assessed without = seen.assess(seen.T_entry_sensor);
  EXPECT_GT((without.T_entry_sensor.translation() - seen.T_entry_sensor.translation()).norm(),
            0.015);
  seen.meeting.precise = seen.here.points;
  seen.meeting.precise_normals = seen.here.normals;
  const Assessed with = seen.assess(seen.T_entry_sensor);
  EXPECT_THAT(with.T_entry_sensor, PoseNear(seen.T_entry_sensor, 0.005, 0.004));
}

TEST(Assess, FindsAWrongPosePoor) {
  const Seen seen;
  const double right = seen.assess(seen.T_entry_sensor).score;
  Random random(1);
  for (int round = 0; round < 10; ++round) {
    Eigen::Isometry3d wrong = seen.T_entry_sensor;
    wrong = testing::random_pose(random, 3.0, 1.5) * wrong;
    wrong.translation().z() += 0.7;
    EXPECT_LT(seen.assess(wrong).score, 0.6 * right);
  }
}

TEST(Assess, GivesTheSameWhicheverOfTheTwoIsCarriedOntoTheOther) {
  const Seen seen;
  const SurfaceGrid query_grid(seen.here.points, seen.here.normals, 0.05, 2);
  const Meeting turned{query_grid, seen.corner.points, seen.corner.normals, true, 0.0};
  Eigen::Isometry3d start = seen.T_entry_sensor;
  start.translation().x() += 0.04;
  Assessed assessed = assess_coarse(turned, seen.entry, seen.query, start);
  assess_fine(turned, seen.entry, seen.query, assessed);
  EXPECT_THAT(assessed.T_entry_sensor, PoseNear(seen.T_entry_sensor, 0.005, 0.004));
  EXPECT_GT(assessed.score, 0.7);
}

TEST(Assess, HasHardlyAScoreForAPoseThatMeetsNothing) {
  const Seen seen;
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().x() = 500.0;
  const Assessed assessed = seen.assess(far);
  EXPECT_EQ(assessed.T_entry_sensor.matrix(), far.matrix());
  EXPECT_EQ(assessed.evidence.overlap, 0.0);
  EXPECT_LT(assessed.score, 0.02);
}

}  // namespace
}  // namespace landmarkdb
