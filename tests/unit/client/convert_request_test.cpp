#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <zstd.h>

#include "client/convert.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

PointCloud small_cloud() {
  PointCloud cloud;
  cloud.points = {{1.5F, -2.25F, 3e-8F},
                  {std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F},
                  {7.0F, 8.0F, 9.0F}};
  cloud.width = 3;
  cloud.height = 1;
  return cloud;
}

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> out(bytes.size() / sizeof(float));
  std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

TEST(CloudToProto, KeepsEveryBitOfEveryPoint) {
  const PointCloud cloud = small_cloud();
  const v1::Cloud out = to_proto(cloud, {.zstd = false});
  EXPECT_EQ(out.encoding(), v1::POINT_ENCODING_FLOAT32);
  EXPECT_EQ(out.points(), 3U);
  EXPECT_FALSE(out.zstd());
  ASSERT_EQ(out.xyz().size(), 36U);
  EXPECT_EQ(std::memcmp(out.xyz().data(), cloud.points.data(), 36), 0);
  EXPECT_TRUE(std::isnan(floats_of(out.xyz())[3]));
  EXPECT_EQ(out.width(), 3U);
  EXPECT_EQ(out.height(), 1U);
  EXPECT_FALSE(out.has_viewpoint());
  EXPECT_FALSE(out.has_origin_m());
}

TEST(CloudToProto, CompressesLosslesslyWhereAskedTo) {
  const PointCloud cloud = small_cloud();
  const v1::Cloud out = to_proto(cloud, {.zstd = true});
  ASSERT_TRUE(out.zstd());
  std::string bytes(36, '\0');
  ASSERT_EQ(ZSTD_decompress(bytes.data(), bytes.size(), out.xyz().data(), out.xyz().size()), 36U);
  EXPECT_EQ(std::memcmp(bytes.data(), cloud.points.data(), 36), 0);
}

TEST(CloudToProto, SendsViewpointAndOrigin) {
  PointCloud cloud = small_cloud();
  cloud.viewpoints = {{1.0F, 2.0F, 3.0F}};
  cloud.origin = {4.5e6, -1.0, 0.0};
  const v1::Cloud out = to_proto(cloud, {});
  EXPECT_EQ(out.viewpoint().z(), 3.0);
  EXPECT_EQ(out.origin_m().x(), 4.5e6);
}

TEST(QueryOptionsToProto, SendsEveryOption) {
  QueryOptions options;
  options.profile = Profile::kPaper;
  options.scenes = {"a", "b"};
  options.top = 5;
  options.min_confidence = 0.0;
  options.up = Eigen::Vector3d(0, 0, 1);
  Eigen::Isometry3d prior = Eigen::Isometry3d::Identity();
  prior.translation() = Eigen::Vector3d(1, 2, 3);
  options.prior_T_scene_sensor = prior;
  options.prior_radius_m = 2.5;
  options.keypoints = KeypointMethod::kIss;
  options.measure = Measure::kBhattacharyya;
  options.search = Search::kFlann;
  options.ratio = 0.0;
  options.filters = {Filter::kSlope, Filter::kRatio};
  options.solver = Solver::kPnp;
  options.estimate_scale = true;
  options.seed = 0;
  options.want_correspondences = true;
  const v1::QueryOptions out = to_proto(options);
  EXPECT_EQ(out.profile(), v1::PROFILE_PAPER);
  EXPECT_THAT(out.scenes(), ElementsAre("a", "b"));
  EXPECT_EQ(out.top(), 5U);
  EXPECT_TRUE(out.has_min_confidence());
  EXPECT_EQ(out.min_confidence(), 0.0);
  EXPECT_EQ(out.up().z(), 1.0);
  EXPECT_THAT(out.prior_t_scene_sensor(),
              ElementsAreArray({1., 0., 0., 1., 0., 1., 0., 2., 0., 0., 1., 3., 0., 0., 0., 1.}));
  EXPECT_EQ(out.prior_radius_m(), 2.5);
  EXPECT_EQ(out.keypoints(), v1::KEYPOINT_METHOD_ISS);
  EXPECT_EQ(out.measure(), v1::MEASURE_BHATTACHARYYA);
  EXPECT_EQ(out.search(), v1::SEARCH_FLANN);
  EXPECT_TRUE(out.has_ratio());
  EXPECT_EQ(out.ratio(), 0.0);
  EXPECT_THAT(out.filters(), ElementsAre(v1::FILTER_SLOPE, v1::FILTER_RATIO));
  EXPECT_EQ(out.solver(), v1::SOLVER_PNP);
  EXPECT_TRUE(out.estimate_scale());
  EXPECT_TRUE(out.has_seed());
  EXPECT_EQ(out.seed(), 0U);
  EXPECT_TRUE(out.want_correspondences());
}

TEST(QueryOptionsToProto, LeavesTheProfilesChoicesToTheProfile) {
  const v1::QueryOptions out = to_proto(QueryOptions{});
  EXPECT_EQ(out.keypoints(), v1::KEYPOINT_METHOD_UNSPECIFIED);
  EXPECT_EQ(out.filters_size(), 0);
  EXPECT_FALSE(out.has_up());
  EXPECT_EQ(out.prior_t_scene_sensor_size(), 0);
}

TEST(SceneAddToProto, SendsScansWithPosesAndNames) {
  SceneAdd add;
  add.name = "yard";
  add.kind = EntryKind::kObject;
  add.voxel_m = 0.05;
  add.scans.push_back({.cloud = small_cloud(), .source = "a.pcd"});
  const v1::SceneAddRequest out = to_proto(add, {});
  EXPECT_EQ(out.name(), "yard");
  EXPECT_EQ(out.kind(), v1::ENTRY_KIND_OBJECT);
  EXPECT_EQ(out.voxel_m(), 0.05);
  EXPECT_FALSE(out.has_radius_m());
  ASSERT_EQ(out.scans_size(), 1);
  EXPECT_EQ(out.scans(0).source(), "a.pcd");
  EXPECT_EQ(out.scans(0).t_scene_cloud_size(), 16);
}

}  // namespace
}  // namespace landmarkdb::client
