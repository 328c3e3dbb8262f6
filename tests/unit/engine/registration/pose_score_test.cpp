#include "engine/registration/pose_score.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::Surface;

float score(const SurfaceGrid& grid,
            const TestPoints& test,
            const Eigen::Isometry3d& T,
            std::size_t count = 512) {
  return score_pose(grid, test, count, T.linear().cast<float>(), T.translation().cast<float>(), {});
}

Eigen::Isometry3d shifted(double x, double y, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

struct Corner {
  Surface surface = testing::corner_room(0.04);
  SurfaceGrid grid{surface.points, surface.normals, 0.05, 2};
  TestPoints test = select_test_points(surface.points, surface.normals, {}, 512, 1);
};

TEST(ScorePose, IsNearOneWhenRightAndFallsWithDistance) {
  const Corner corner;
  const float right = score(corner.grid, corner.test, Eigen::Isometry3d::Identity());
  EXPECT_GT(right, 0.95F);
  EXPECT_LE(right, 1.0F + 1e-5F);
  float before = right;
  for (const double off : {0.02, 0.05, 0.08}) {
    const float less = score(corner.grid, corner.test, shifted(off, off, off));
    EXPECT_LT(less, before);
    before = less;
  }
}

TEST(ScorePose, IsLowForWrongPoses) {
  const Corner corner;
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    Eigen::Isometry3d wrong = testing::random_pose(random, 3.0, 2.0);
    wrong.translation().x() += 0.5;
    EXPECT_LT(score(corner.grid, corner.test, wrong), 0.6F);
  }
}

TEST(ScorePose, GivesAHopelessPoseUpAfterTheFirstLook) {
  const Corner corner;
  const float hopeless = score(corner.grid, corner.test, shifted(100, 0, 0));
  EXPECT_EQ(hopeless, -1.0F);
  // Given up by the first 32 alone: with no more points than these it is not.
  EXPECT_EQ(score(corner.grid, corner.test, shifted(100, 0, 0), 32), 0.0F);
  ScoreOptions patient;
  patient.hopeless = 0.0F;
  EXPECT_EQ(score_pose(corner.grid,
                       corner.test,
                       512,
                       Eigen::Matrix3f::Identity(),
                       Eigen::Vector3f(100, 0, 0),
                       patient),
            0.0F);
}

TEST(ScorePose, CountsSurfacesThatFaceTheOtherWayForNothing) {
  Corner corner;
  std::vector<Eigen::Vector3f> normals(corner.test.normals().begin(), corner.test.normals().end());
  for (Eigen::Vector3f& n : normals) n = -n;
  corner.test = {{corner.test.points().begin(), corner.test.points().end()}, normals};
  EXPECT_LE(score(corner.grid, corner.test, Eigen::Isometry3d::Identity()), 0.0F);
}

TEST(ScorePose, TakesNoMorePointsThanThereAreAndNoneForNoPose) {
  const Corner corner;
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  EXPECT_EQ(score(corner.grid, corner.test, T, 512), score(corner.grid, corner.test, T, 100'000));
  EXPECT_LT(score(corner.grid, TestPoints{}, T), 0.0F);
  EXPECT_LT(score(corner.grid, corner.test, T, 0), 0.0F);
}

TEST(SelectTestPoints, RepeatsForASeedAndEachPointIsTakenOnce) {
  const Surface room = testing::corner_room(0.05);
  const TestPoints a = select_test_points(room.points, room.normals, {}, 300, 7);
  const TestPoints b = select_test_points(room.points, room.normals, {}, 300, 7);
  const TestPoints c = select_test_points(room.points, room.normals, {}, 300, 8);
  ASSERT_EQ(a.size(), 300U);
  EXPECT_TRUE(std::ranges::equal(a.points(), b.points()));
  EXPECT_TRUE(std::ranges::equal(a.normals(), b.normals()));
  EXPECT_FALSE(std::ranges::equal(a.points(), c.points()));
  const TestPoints all = select_test_points(room.points, room.normals, {}, 1'000'000, 1);
  ASSERT_EQ(all.size(), room.points.size());
  const auto by_place = [](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  };
  std::vector<Eigen::Vector3f> drawn(all.points().begin(), all.points().end());
  std::vector<Eigen::Vector3f> given = room.points;
  std::sort(drawn.begin(), drawn.end(), by_place);
  std::sort(given.begin(), given.end(), by_place);
  EXPECT_EQ(drawn, given);
  EXPECT_EQ(select_test_points({}, {}, {}, 10, 1).size(), 0U);
}

TEST(SelectTestPoints, IsAPrefixOfALongerDraw) {
  const Surface room = testing::corner_room(0.05);
  const TestPoints few = select_test_points(room.points, room.normals, {}, 50, 7);
  const TestPoints many = select_test_points(room.points, room.normals, {}, 500, 7);
  EXPECT_TRUE(std::equal(few.points().begin(), few.points().end(), many.points().begin()));
}

TEST(SelectTestPoints, FavoursRareDirections) {
  // A floor of 10,000 points and a step of 100: drawn evenly, one in a hundred is of the step.
  std::vector<Eigen::Vector3f> points, normals;
  for (int i = 0; i < 10'100; ++i) {
    points.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
    normals.push_back(i < 10'000 ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX());
  }
  const TestPoints test = select_test_points(points, normals, {}, 400, 1);
  const auto rare = std::count_if(test.normals().begin(),
                                  test.normals().end(),
                                  [](const Eigen::Vector3f& n) { return n.x() > 0.5F; });
  EXPECT_GT(rare, 20);  // chances of 10 to 1: about one in eleven
  EXPECT_LT(rare, 60);
}

}  // namespace
}  // namespace landmarkdb
