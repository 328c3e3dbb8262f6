#include "engine/cloud/prepare_cloud.hpp"

#include <stop_token>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/cloud/sanitise.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "tests/unit/engine/cloud/shapes.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr PrepareOptions kOptions{.voxel_m = 0.1, .normal_radius_m = 0.3};

TEST(PrepareCloud, ThinsAndTurnsNormalsToTheViewpoint) {
  PointCloud cloud = testing::make_room({5, 4, 3}, 0.05F);
  cloud.viewpoints = {{2, 2, 1}};
  const CloudCounts counts = sanitise(cloud);
  const PreparedCloud prepared = prepare_cloud(cloud, counts, kOptions, {});
  EXPECT_LT(prepared.size(), cloud.size() / 2);
  ASSERT_EQ(prepared.normals.size(), prepared.size());
  EXPECT_TRUE(prepared.normals_from_viewpoint);
  EXPECT_EQ(prepared.resolution_m, 0.1);
  EXPECT_EQ(prepared.counts.used, cloud.size());
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    EXPECT_GE(prepared.normals[i].dot(prepared.viewpoints[0] - prepared.points[i]), 0.0F);
    EXPECT_NEAR(prepared.normals[i].norm(), 1.0F, 1e-4F);
  }
}

TEST(PrepareCloud, DropsStraysWhereItIsAskedTo) {
  PointCloud cloud = testing::make_room({5, 4, 3}, 0.05F);
  const PreparedCloud without = prepare_cloud(cloud, {}, kOptions, {});
  cloud.points.emplace_back(2.5F, 2, 1.5F);
  PrepareOptions options = kOptions;
  EXPECT_EQ(prepare_cloud(cloud, {}, options, {}).size(), without.size() + 1);
  options.without_strays = true;
  EXPECT_EQ(prepare_cloud(cloud, {}, options, {}).points, without.points);
}

TEST(PrepareCloud, SaysWhenNothingKnewTheOrientation) {
  const PointCloud cloud = testing::make_room({5, 4, 3}, 0.1F);
  EXPECT_FALSE(prepare_cloud(cloud, {}, kOptions, {}).normals_from_viewpoint);
}

TEST(PrepareCloud, KeepsTheCloudsOwnNormals) {
  PointCloud cloud = testing::make_sphere(2000, 1.0F);
  for (const Eigen::Vector3f& p : cloud.points) cloud.normals.push_back(-p);
  const PreparedCloud prepared = prepare_cloud(cloud, {}, kOptions, {});
  EXPECT_TRUE(prepared.normals_from_viewpoint);
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    EXPECT_LT(prepared.normals[i].dot(prepared.points[i]), -0.9F);
  }
}

TEST(PrepareCloud, MakesNewNormalsWhereAViewpointContradicts) {
  PointCloud cloud = testing::make_sphere(2000, 1.0F);
  for (const Eigen::Vector3f& p : cloud.points) cloud.normals.push_back(p);
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  const PreparedCloud prepared = prepare_cloud(cloud, {}, kOptions, {});
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    EXPECT_LT(prepared.normals[i].dot(prepared.points[i]), 0.0F);
  }
}

TEST(PrepareCloud, OrientsAnewNormalsWithoutACommonSide) {
  PointCloud cloud = testing::make_sphere(4000, 1.0F);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.normals.push_back(i % 2 == 0 ? cloud.points[i] : Eigen::Vector3f(-cloud.points[i]));
  }
  const PreparedCloud prepared =
      prepare_cloud(cloud, {}, {.voxel_m = 0.02, .normal_radius_m = 0.2}, {});
  EXPECT_FALSE(prepared.normals_from_viewpoint);
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    EXPECT_GT(prepared.normals[i].dot(prepared.points[i]), 0.0F);
  }
}

TEST(PrepareCloud, RefusesWhatIsNoSurface) {
  PointCloud cloud;
  EXPECT_THAT([&] { prepare_cloud(cloud, {}, kOptions, {}); },
              ThrowsMessage<Error>(HasSubstr("0 points")));
  cloud.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THAT([&] { prepare_cloud(cloud, {}, kOptions, {}); },
              ThrowsMessage<Error>(HasSubstr("3 points")));
  cloud.points.clear();
  for (int i = 0; i < 100; ++i) {
    cloud.points.push_back(static_cast<float>(i) * Eigen::Vector3f(0.3F, 0.2F, 0.1F));
  }
  EXPECT_THAT([&] { prepare_cloud(cloud, {}, kOptions, {}); },
              ThrowsMessage<Error>(HasSubstr("one line")));
}

TEST(PrepareCloud, TakesAPlaneAlone) {
  PointCloud cloud;
  for (int i = 0; i < 2500; ++i) {
    cloud.points.emplace_back(
        0.1F * static_cast<float>(i % 50), 0.1F * static_cast<float>(i / 50), 1);
  }
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  const PreparedCloud prepared = prepare_cloud(cloud, {}, kOptions, {});
  EXPECT_NEAR(prepared.normals[100].z(), -1.0F, 1e-4F);
}

// A long query used to be cleaned and thinned to the end whatever its deadline.
TEST(Preprocessing, StopsInEachOfItsSteps) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  Random random(1);
  PointCloud cloud;
  for (int i = 0; i < 400'000; ++i) {  // a kd-tree looks at the token every million coordinates
    cloud.points.emplace_back(static_cast<float>(random.uniform()),
                              static_cast<float>(random.uniform()),
                              static_cast<float>(random.uniform()));
  }
  EXPECT_THROW(thin(cloud, 0.1, context), Error);
  EXPECT_THROW(measure_scale(cloud, context), Error);
  EXPECT_THROW(SpatialIndex(cloud.points, context), Error);
  EXPECT_THROW(sanitise(cloud, context), Error);
}

}  // namespace
}  // namespace landmarkdb
