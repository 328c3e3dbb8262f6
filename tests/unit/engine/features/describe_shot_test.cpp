#include "engine/features/describe_shot.hpp"

#include <cmath>
#include <limits>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::corner_room;
using testing::every;

constexpr double kRadius = 0.3;

TEST(DescribeShot, GivesUnitDescriptorsWithExactFramesInInputOrder) {
  const PreparedCloud cloud = corner_room(1);
  Keypoints keypoints = every(cloud, 31);
  std::reverse(keypoints.index.begin(), keypoints.index.end());
  const DescriptorSet set = describe_shot(cloud, keypoints, kRadius, {});
  ASSERT_EQ(set.size() + set.dropped, keypoints.size());
  ASSERT_EQ(set.dropped, 0U);
  ASSERT_EQ(set.values.size(), set.size() * kShotLength);
  ASSERT_EQ(set.frames.size(), set.size());
  ASSERT_EQ(set.normals.size(), set.size());
  for (std::size_t i = 0; i < set.size(); ++i) {
    EXPECT_EQ(set.keypoints[i], cloud.points[keypoints.index[i]]);
    EXPECT_EQ(set.normals[i], cloud.normals[keypoints.index[i]]);
    double squared = 0.0;
    for (const float v : set.row(i)) {
      EXPECT_GE(v, 0.0F);
      squared += static_cast<double>(v) * static_cast<double>(v);
    }
    EXPECT_NEAR(squared, 1.0, 1e-5);
    EXPECT_LT((set.frames[i] * set.frames[i].transpose() - Eigen::Matrix3f::Identity()).norm(),
              1e-6F);
    EXPECT_NEAR(set.frames[i].determinant(), 1.0F, 1e-6F);
  }
}

TEST(DescribeShot, GivesTheSameBytesForAnyThreadCount) {
  const PreparedCloud cloud = corner_room(2);
  const Keypoints keypoints = every(cloud, 11);
  RunContext one;
  RunContext three;
  three.threads = 3;
  const DescriptorSet a = describe_shot(cloud, keypoints, kRadius, one);
  const DescriptorSet b = describe_shot(cloud, keypoints, kRadius, three);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.dropped, b.dropped);
}

// The frame turns with the cloud and the descriptor stays, which is what SHOT is for. Ties of the
// frame's signs may fall either way after rounding, so nearly all must agree, not all.
TEST(DescribeShot, FrameTurnsWithTheCloudAndDescriptorStays) {
  const PreparedCloud cloud = corner_room(3);
  const Keypoints keypoints = every(cloud, 17);
  const Eigen::Matrix3f R = rotation_from_vector(Eigen::Vector3d(0.4, -1.1, 2.0)).cast<float>();
  PreparedCloud turned = cloud;
  for (Eigen::Vector3f& p : turned.points) p = R * p + Eigen::Vector3f(5, -2, 1);
  for (Eigen::Vector3f& n : turned.normals) n = R * n;
  const DescriptorSet a = describe_shot(cloud, keypoints, kRadius, {});
  const DescriptorSet b = describe_shot(turned, keypoints, kRadius, {});
  ASSERT_EQ(a.size(), b.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    float worst = 0.0F;
    for (std::size_t j = 0; j < kShotLength; ++j) {
      worst = std::max(worst, std::abs(a.row(i)[j] - b.row(i)[j]));
    }
    if (worst < 0.02F && (R * a.frames[i] - b.frames[i]).norm() < 0.01F) ++same;
  }
  EXPECT_GT(static_cast<double>(same), 0.9 * static_cast<double>(a.size()));
}

TEST(DescribeShot, DropsAndCountsKeypointsWithoutNeighbours) {
  PreparedCloud cloud = corner_room(4);
  testing::add_point(cloud, {50, 50, 50}, {0, 0, 1});
  Keypoints keypoints;
  keypoints.index = {0, static_cast<std::uint32_t>(cloud.size() - 1), 40};
  const DescriptorSet set = describe_shot(cloud, keypoints, kRadius, {});
  EXPECT_EQ(set.dropped, 1U);
  ASSERT_EQ(set.size(), 2U);
  EXPECT_EQ(set.keypoints[1], cloud.points[40]);
  EXPECT_EQ(set.values.size(), 2 * kShotLength);
}

TEST(DescribeShot, SurvivesPointsOnOneLineOnePlaceAndNoKeypoints) {
  PreparedCloud line;
  for (int i = 0; i < 50; ++i) testing::add_point(line, {0.01 * i, 0, 0}, {0, 0, 1});
  const DescriptorSet on_line = describe_shot(line, every(line, 1), 0.1, {});
  EXPECT_EQ(on_line.size() + on_line.dropped, 50U);
  for (const float v : on_line.values) EXPECT_TRUE(std::isfinite(v));
  PreparedCloud place;
  for (int i = 0; i < 50; ++i) testing::add_point(place, {1, 2, 3}, {0, 0, 1});
  EXPECT_EQ(describe_shot(place, every(place, 1), 0.1, {}).dropped, 50U);
  EXPECT_EQ(describe_shot(line, {}, 0.1, {}).size(), 0U);
  EXPECT_EQ(describe_shot({}, {}, 0.1, {}).size(), 0U);
}

TEST(DescribeShot, RefusesWhatPclMustNotSee) {
  const PreparedCloud good = corner_room(5);
  const Keypoints keypoints = every(good, 500);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PreparedCloud cloud = good;
  cloud.points[7].y() = nan;
  EXPECT_THROW(describe_shot(cloud, keypoints, kRadius, {}), Error);
  cloud = good;
  cloud.normals[7].z() = std::numeric_limits<float>::infinity();
  EXPECT_THROW(describe_shot(cloud, keypoints, kRadius, {}), Error);
  cloud = good;
  cloud.normals.pop_back();
  EXPECT_THROW(describe_shot(cloud, keypoints, kRadius, {}), Error);
  EXPECT_THROW(describe_shot(good, keypoints, 0.0, {}), Error);
  EXPECT_THROW(describe_shot(good, keypoints, static_cast<double>(nan), {}), Error);
  EXPECT_THROW(describe_shot(good, keypoints, 1e-9, {}), Error);
  Keypoints outside;
  outside.index = {static_cast<std::uint32_t>(good.size())};
  EXPECT_THROW(describe_shot(good, outside, kRadius, {}), Error);
}

TEST(DescribeShot, StopsWhenAskedAndTellsItsProgress) {
  const PreparedCloud cloud = corner_room(6);
  const Keypoints keypoints = every(cloud, 5);
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  std::uint64_t last = 0;
  context.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "describe");
    EXPECT_EQ(progress.total, keypoints.size());
    last = progress.done;
  };
  describe_shot(cloud, keypoints, kRadius, context);
  EXPECT_EQ(last, keypoints.size());
  context.progress = [&](const Progress& progress) {
    if (progress.done > 0) stop.request_stop();
  };
  EXPECT_THROW(describe_shot(cloud, keypoints, kRadius, context), Error);
}

}  // namespace
}  // namespace landmarkdb
