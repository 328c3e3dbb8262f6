#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "datasets/depth_camera.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

const Place& office() {
  static const Place place = make_place({.type = PlaceType::kOffice, .seed = 3, .size = 0.6});
  return place;
}

TEST(RenderLidar, PutsPointsOnItsRings) {
  const Eigen::Isometry3d T = sample_upright_poses(office(), 1, 1)[0];
  const PointCloud cloud = render_lidar(office(), T, {.noise_m = 0.0, .mixed_pixels = 0.0}, {});
  ASSERT_GT(cloud.size(), 16U * 1800U / 2U);
  ASSERT_LE(cloud.size(), 16U * 1800U);
  for (const Eigen::Vector3f& p : cloud.points) {
    const double elevation_deg = std::asin(p.z() / p.norm()) * 180.0 / std::numbers::pi;
    const double ring = (elevation_deg + 15.0) / 2.0;
    ASSERT_NEAR(ring, std::round(ring), 0.01);
    const Eigen::Vector3f q = (T * p.cast<double>()).cast<float>();
    const Eigen::Vector3f eye = T.translation().cast<float>();
    const auto hit = office().caster->first_hit(eye, (q - eye).normalized(), 200.0F);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->distance_m, (q - eye).norm(), 0.002);
  }
}

TEST(RenderLidar, IsTheSameForAnyNumberOfThreads) {
  const Eigen::Isometry3d T = sample_upright_poses(office(), 1, 1)[0];
  RunContext one, three;
  three.threads = 3;
  EXPECT_EQ(render_lidar(office(), T, {}, one).points, render_lidar(office(), T, {}, three).points);
}

TEST(RenderLidar, RefusesLasersThatCannotBe) {
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  EXPECT_THROW(render_lidar(office(), T, {.lines = 0}, {}), Error);
  EXPECT_THROW(render_lidar(office(), T, {.columns = 1'000'000}, {}), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
