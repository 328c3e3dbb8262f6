#include "engine/features/range_noise.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/cloud/prepare_cloud.hpp"
#include "engine/cloud/sanitise.hpp"

namespace landmarkdb {
namespace {

constexpr double kVoxel_m = 0.05;
constexpr double kRadius_m = 0.125;

// Two walls that face a depth camera at the origin, one at 2 m, one at 6 m, with noise along the
// ray that grows with the square of the range.
constexpr double kNear_m = 2.0;
constexpr double kFar_m = 6.0;

PointCloud two_walls(double noise_at_one_metre, std::uint64_t seed = 1) {
  Random random(seed);
  PointCloud cloud;
  cloud.viewpoints.emplace_back(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < 60'000; ++i) {
    const bool far = i % 2 == 0;
    const double z = far ? kFar_m : kNear_m;
    const double slope = far ? random.uniform(0.02, 0.3) : random.uniform(-0.6, -0.02);
    const Eigen::Vector3d p(slope * z, random.uniform(-0.3, 0.3) * z, z);
    const double range = p.norm();
    const double off = noise_at_one_metre * range * range * random.normal();
    cloud.points.push_back((p * (1.0 + off / range)).cast<float>());
  }
  return cloud;
}

PreparedCloud prepared(PointCloud cloud) {
  const CloudCounts counts = sanitise(cloud);
  return prepare_cloud(cloud, counts, {kVoxel_m, kRadius_m}, {});
}

// Mean distance of the far wall's points from it, and the share of its normals within 15 deg.
struct Quality {
  double distance_m = 0.0;
  double good_normals = 0.0;
};

Quality far_quality(const PreparedCloud& cloud) {
  Quality quality;
  double points = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p = cloud.points[i].cast<double>();
    if (p.z() < 4.0 || p.x() < 0.5 || p.x() > 1.5 || std::abs(p.y()) > 1.4) continue;  // no edges
    points += 1.0;
    quality.distance_m += std::abs(p.z() - kFar_m);
    quality.good_normals += cloud.normals[i].z() < -0.966F ? 1.0 : 0.0;
  }
  quality.distance_m /= points;
  quality.good_normals /= points;
  return quality;
}

TEST(MeasureRangeNoise, GrowsWithTheRangeAndIsNearTheTruth) {
  const RangeNoise noise = measure_range_noise(prepared(two_walls(0.001)), kRadius_m, {});
  ASSERT_FALSE(noise.sigma_m.empty());
  EXPECT_NEAR(noise.at(2.1F), 0.004F, 0.003F);
  EXPECT_NEAR(noise.at(6.2F), 0.036F, 0.015F);
  for (float range = 1.0F; range < 8.0F; range += 0.5F) {
    EXPECT_LE(noise.at(range), noise.at(range + 0.5F));
  }
}

TEST(MeasureRangeNoise, IsNothingWithoutAViewpoint) {
  PreparedCloud cloud = prepared(two_walls(0.001));
  cloud.viewpoints.clear();
  cloud.viewpoint_index.clear();
  EXPECT_EQ(measure_range_noise(cloud, kRadius_m, {}).at(5.0F), 0.0F);
}

TEST(FlattenRangeNoise, MakesFarWallsThinAndTheirNormalsRight) {
  PreparedCloud cloud = prepared(two_walls(0.002));
  const Quality before = far_quality(cloud);
  const std::size_t points_before = cloud.size();
  flatten_range_noise(cloud, measure_range_noise(cloud, kRadius_m, {}), kRadius_m, {});
  const Quality after = far_quality(cloud);
  EXPECT_LT(after.distance_m, 0.6 * before.distance_m);
  EXPECT_GT(after.good_normals, before.good_normals + 0.2);
  EXPECT_LT(cloud.size(), points_before);
  EXPECT_EQ(cloud.normals.size(), cloud.size());
}

// A floor far ahead of a low sensor that grazes it: the noise is along the rays, and hardly leaves
// the floor.
PointCloud grazed_floor(double noise_at_one_metre) {
  constexpr double kHeight_m = 0.8;
  Random random(2);
  PointCloud cloud;
  cloud.viewpoints.emplace_back(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < 60'000; ++i) {
    const Eigen::Vector3d p(random.uniform(-2.0, 2.0), kHeight_m, random.uniform(3.0, 7.0));
    const double range = p.norm();
    const double off = noise_at_one_metre * range * range * random.normal();
    cloud.points.push_back((p * (1.0 + off / range)).cast<float>());
  }
  return cloud;
}

TEST(MeasureRangeNoise, IsMeasuredAlongTheRaysOfWhatTheyGraze) {
  const RangeNoise noise = measure_range_noise(prepared(grazed_floor(0.001)), kRadius_m, {});
  EXPECT_NEAR(noise.at(5.0F), 0.025F, 0.012F);
  EXPECT_NEAR(noise.at(6.2F), 0.038F, 0.018F);
}

TEST(RangeWeights, TrustsNearPointsMoreThanFarOnes) {
  const PreparedCloud cloud = prepared(two_walls(0.002));
  const RangeNoise noise = measure_range_noise(cloud, kRadius_m, {});
  const std::vector<float> measured = range_weights(cloud, noise, 1.0F);
  const std::vector<float> laid_flat = range_weights(cloud, noise, 0.1F);
  ASSERT_EQ(measured.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.points[i].z() > 4.0F) {
      ASSERT_LT(measured[i], 0.8F);
    } else {
      ASSERT_GT(measured[i], 0.5F);
    }
    ASSERT_GE(laid_flat[i], measured[i]);
  }
  EXPECT_THAT(range_weights(cloud, RangeNoise{}, 1.0F), ::testing::Each(1.0F));
}

TEST(RangeWeights, TrustsAFloorFarAwayMoreThanAWallThatFacesTheSensor) {
  const auto mean_weight = [](const PreparedCloud& cloud) {
    const std::vector<float> weights =
        range_weights(cloud, measure_range_noise(cloud, kRadius_m, {}), 1.0F);
    double sum = 0.0;
    double far = 0.0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.points[i].norm() < 5.5F || cloud.points[i].norm() > 6.5F) continue;
      sum += static_cast<double>(weights[i]);
      far += 1.0;
    }
    return sum / far;
  };
  EXPECT_GT(mean_weight(prepared(grazed_floor(0.002))),
            2.0 * mean_weight(prepared(two_walls(0.002))));
}

TEST(FlattenRangeNoise, LeavesACleanCloudAsItIs) {
  PreparedCloud cloud = prepared(two_walls(0.0));
  const std::vector<Eigen::Vector3f> before = cloud.points;
  flatten_range_noise(cloud, measure_range_noise(cloud, kRadius_m, {}), kRadius_m, {});
  EXPECT_EQ(cloud.points, before);
}

TEST(FlattenRangeNoise, GivesTheSameOnAnyNumberOfThreads) {
  const PreparedCloud cloud = prepared(two_walls(0.002));
  RunContext context;
  PreparedCloud one = cloud;
  context.threads = 1;
  flatten_range_noise(one, measure_range_noise(one, kRadius_m, context), kRadius_m, context);
  PreparedCloud three = cloud;
  context.threads = 3;
  flatten_range_noise(three, measure_range_noise(three, kRadius_m, context), kRadius_m, context);
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.normals, three.normals);
}

// A ball of four normals' radii without noise, which a plane does not fit.
TEST(MeasureRangeNoise, DoesNotTakeABendForNoiseWhereSurfaceMayBend) {
  Random random(3);
  PointCloud cloud;
  cloud.viewpoints.emplace_back(0.0F, 0.0F, 0.0F);
  for (int i = 0; i < 40'000; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Eigen::Vector3d p = Eigen::Vector3d(0, 0, 2) + 4.0 * kRadius_m * direction;
    if (direction.dot(p) < 0.0) cloud.points.push_back(p.cast<float>());
  }
  const PreparedCloud ball = prepared(std::move(cloud));
  const float flat = measure_range_noise(ball, kRadius_m, {}).at(1.6F);
  const float bent = measure_range_noise(ball, kRadius_m, {}, SurfaceShape::kBent).at(1.6F);
  EXPECT_GT(flat, 0.05 * kVoxel_m);
  EXPECT_LT(bent, 0.3F * flat);
}

}  // namespace
}  // namespace landmarkdb
