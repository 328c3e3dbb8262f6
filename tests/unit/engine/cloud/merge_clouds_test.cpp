#include "engine/cloud/merge_clouds.hpp"

#include <array>
#include <numbers>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

PointCloud two_points() {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}, {2, 0, 0}};
  cloud.normals = {{1, 0, 0}, {0, 1, 0}};
  cloud.colours = {{1, 2, 3}, {4, 5, 6}};
  cloud.viewpoints = {{0, 0, 1}};
  return cloud;
}

Eigen::Isometry3d quarter_turn_then(const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = t;
  return T;
}

TEST(MergeClouds, CarriesEverythingIntoTheSceneFrame) {
  const std::array clouds{two_points(), two_points()};
  const std::array poses{Eigen::Isometry3d::Identity(), quarter_turn_then({10, 0, 0})};
  const PointCloud merged = merge_clouds(clouds, poses);
  ASSERT_EQ(merged.size(), 4U);
  EXPECT_TRUE(merged.points[3].isApprox(Eigen::Vector3f(10, 2, 0)));
  ASSERT_EQ(merged.normals.size(), 4U);
  EXPECT_TRUE(merged.normals[3].isApprox(Eigen::Vector3f(-1, 0, 0)));
  EXPECT_EQ(merged.colours[3], (std::array<std::uint8_t, 3>{4, 5, 6}));
  ASSERT_EQ(merged.viewpoints.size(), 2U);
  EXPECT_TRUE(merged.viewpoints[1].isApprox(Eigen::Vector3f(10, 0, 1)));
  EXPECT_THAT(merged.viewpoint_index, ::testing::ElementsAre(0, 0, 1, 1));
}

TEST(MergeClouds, KeepsOnlyWhatAllHave) {
  std::array clouds{two_points(), two_points()};
  clouds[1].normals.clear();
  clouds[1].colours.clear();
  clouds[1].viewpoints.clear();
  const std::array poses{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
  const PointCloud merged = merge_clouds(clouds, poses);
  EXPECT_EQ(merged.size(), 4U);
  EXPECT_TRUE(merged.normals.empty());
  EXPECT_TRUE(merged.colours.empty());
  EXPECT_TRUE(merged.viewpoints.empty());
  EXPECT_TRUE(merged.viewpoint_index.empty());
}

TEST(MergeClouds, BringsDifferentOriginsTogether) {
  std::array clouds{two_points(), two_points()};
  clouds[0].origin = {432'000, 5'123'000, 100};
  clouds[1].origin = {432'100, 5'123'000, 100};
  const std::array poses{Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
  const PointCloud merged = merge_clouds(clouds, poses);
  const Eigen::Vector3d last = merged.origin + merged.points[3].cast<double>();
  EXPECT_TRUE(last.isApprox(Eigen::Vector3d(432'102, 5'123'000, 100), 1e-12));
  EXPECT_LT(merged.points[3].norm(), 1000.0F);
}

TEST(MergeClouds, TakesOneCloudThrough) {
  const std::array clouds{two_points()};
  const std::array poses{Eigen::Isometry3d::Identity()};
  const PointCloud merged = merge_clouds(clouds, poses);
  EXPECT_EQ(merged.points, clouds[0].points);
  EXPECT_TRUE(merged.viewpoint_index.empty());
}

TEST(MergeClouds, StopsWhenAskedTo) {
  const std::array clouds{two_points()};
  const std::array poses{Eigen::Isometry3d::Identity()};
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_THROW(merge_clouds(clouds, poses, context), Error);
}

TEST(MergeClouds, RefusesAWrongNumberOfPoses) {
  const std::array clouds{two_points()};
  EXPECT_THROW(merge_clouds(clouds, {}), Error);
}

}  // namespace
}  // namespace landmarkdb
