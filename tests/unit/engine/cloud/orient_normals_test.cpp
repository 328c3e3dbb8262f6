#include "engine/cloud/orient_normals.hpp"

#include <gtest/gtest.h>

#include "engine/cloud/normals.hpp"
#include "tests/unit/engine/cloud/shapes.hpp"

namespace landmarkdb {
namespace {

// Share of the points whose normal has a positive cosine with `wanted(point)`.
template <typename Wanted>
double share_facing(const PointCloud& cloud, const Wanted& wanted) {
  std::size_t facing = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.normals[i].dot(wanted(cloud.points[i])) > 0.0F) ++facing;
  }
  return static_cast<double>(facing) / static_cast<double>(cloud.size());
}

TEST(OrientConsistently, TurnsAnObjectOutwards) {
  PointCloud cloud = testing::make_sphere(3000, 0.2F);
  estimate_normals(cloud, 0.03, SpatialIndex(cloud.points), {});
  EXPECT_EQ(share_facing(cloud, [](const Eigen::Vector3f& p) { return p; }), 1.0);
}

TEST(OrientConsistently, TurnsARoomInwards) {
  PointCloud cloud = testing::make_room({6, 5, 3}, 0.08F);
  estimate_normals(cloud, 0.2, SpatialIndex(cloud.points), {});
  const Eigen::Vector3f centre(3.0F, 2.5F, 1.5F);
  EXPECT_GT(
      share_facing(cloud, [&](const Eigen::Vector3f& p) { return Eigen::Vector3f(centre - p); }),
      0.999);
}

TEST(OrientConsistently, TurnsABallInARoomOutwards) {
  PointCloud cloud = testing::make_room({6, 5, 3}, 0.08F);
  const std::size_t walls = cloud.size();
  const Eigen::Vector3f at(2.0F, 2.0F, 1.2F);
  for (const Eigen::Vector3f& p : testing::make_sphere(2000, 0.5F).points) {
    cloud.points.push_back(at + p);
  }
  estimate_normals(cloud, 0.15, SpatialIndex(cloud.points), {});
  std::size_t outwards = 0;
  for (std::size_t i = walls; i < cloud.size(); ++i) {
    if (cloud.normals[i].dot(cloud.points[i] - at) > 0.0F) ++outwards;
  }
  EXPECT_EQ(outwards, 2000U);
}

TEST(OrientConsistently, LeavesZeroNormalsAlone) {
  const PointCloud cloud = testing::make_sphere(50, 1.0F);
  std::vector<Eigen::Vector3f> normals(50, Eigen::Vector3f::Zero());
  orient_consistently(cloud.points, normals, SpatialIndex(cloud.points), {});
  for (const Eigen::Vector3f& normal : normals) EXPECT_TRUE(normal.isZero());
}

}  // namespace
}  // namespace landmarkdb
