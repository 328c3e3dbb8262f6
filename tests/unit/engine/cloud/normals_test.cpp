#include "engine/cloud/normals.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/cloud/shapes.hpp"

namespace landmarkdb {
namespace {

TEST(EstimateNormals, FitsASphereAndTurnsToTheViewpoint) {
  PointCloud cloud = testing::make_sphere(3000, 1.0F);
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  const SpatialIndex index(cloud.points);
  EXPECT_TRUE(estimate_normals(cloud, 0.15, index, {}));
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(cloud.normals[i].dot(cloud.points[i]), -0.99F);
    EXPECT_NEAR(cloud.normals[i].norm(), 1.0F, 1e-5F);
  }
}

TEST(EstimateNormals, TurnsEachPointToItsOwnViewpoint) {
  PointCloud cloud;
  for (int i = 0; i < 400; ++i) {
    cloud.points.emplace_back(
        0.1F * static_cast<float>(i % 20), 0.1F * static_cast<float>(i / 20), 0);
    cloud.viewpoint_index.push_back(i / 20 < 10 ? 0 : 1);
  }
  cloud.viewpoints = {{1, 1, 5}, {1, 1, -5}};
  estimate_normals(cloud, 0.25, SpatialIndex(cloud.points), {});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_NEAR(cloud.normals[i].z(), i < 200 ? 1.0F : -1.0F, 1e-4F) << i;
  }
}

TEST(EstimateNormals, IsTheSameForAnyNumberOfThreads) {
  const PointCloud room = testing::make_room({5, 4, 3}, 0.1F);
  const SpatialIndex index(room.points);
  for (const bool known : {false, true}) {
    PointCloud one = room;
    if (known) one.viewpoints = {{2, 2, 1}};
    PointCloud many = one;
    RunContext context;
    estimate_normals(one, 0.3, index, context);
    context.threads = 5;
    estimate_normals(many, 0.3, index, context);
    EXPECT_EQ(one.normals, many.normals);
  }
}

// A floor as a laser sees it from afar: lines of points 5 cm apart, the lines 30 cm from each
// other, a few millimetres of noise.
TEST(EstimateNormals, LooksAcrossTheLinesOfAFarScanner) {
  PointCloud cloud;
  for (int line = 0; line < 8; ++line) {
    for (int k = 0; k < 60; ++k) {
      const float noise = 0.004F * std::sin(static_cast<float>(17 * line + 5 * k * k));
      cloud.points.emplace_back(
          0.05F * static_cast<float>(k), 0.3F * static_cast<float>(line), noise);
    }
  }
  cloud.viewpoints = {{0, 0, 2}};
  estimate_normals(cloud, 0.125, SpatialIndex(cloud.points), {});
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_GT(cloud.normals[i].z(), 0.95F) << i;
}

TEST(EstimateNormals, GivesCollinearPointsTheDirectionToTheViewpoint) {
  PointCloud cloud;
  for (int i = 0; i < 10; ++i) cloud.points.emplace_back(static_cast<float>(i), 0, 0);
  const SpatialIndex index(cloud.points);
  EXPECT_FALSE(estimate_normals(cloud, 2.5, index, {}));
  EXPECT_EQ(cloud.normals[4], Eigen::Vector3f(0, 0, 1));
  cloud.viewpoints = {{4, 3, 0}};
  EXPECT_TRUE(estimate_normals(cloud, 2.5, index, {}));
  EXPECT_EQ(cloud.normals[4], Eigen::Vector3f(0, 1, 0));
}

TEST(EstimateNormals, TakesTheNearestWhereTheRadiusHoldsTooFew) {
  PointCloud cloud = testing::make_sphere(500, 1.0F);
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  estimate_normals(cloud, 1e-3, SpatialIndex(cloud.points), {});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(cloud.normals[i].dot(cloud.points[i]), -0.9F);
  }
}

TEST(EstimateNormals, RefusesARadiusThatIsNoLengthAndStopsWhenAsked) {
  PointCloud cloud = testing::make_sphere(100, 1.0F);
  const SpatialIndex index(cloud.points);
  EXPECT_THROW(estimate_normals(cloud, 0.0, index, {}), Error);
  EXPECT_THROW(estimate_normals(cloud, std::nan(""), index, {}), Error);
  std::stop_source source;
  source.request_stop();
  RunContext context;
  context.stop = source.get_token();
  EXPECT_THROW(estimate_normals(cloud, 0.3, index, context), Error);
}

}  // namespace
}  // namespace landmarkdb
