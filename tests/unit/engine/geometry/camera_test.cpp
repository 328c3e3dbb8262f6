#include "engine/geometry/camera.hpp"

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

Camera kinect() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 525.0;
  camera.fy = 520.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

TEST(Undistort, IsExactWithoutDistortion) {
  const std::optional<Eigen::Vector2d> ray = undistort(kinect(), {319.5 + 525.0, 239.5 - 520.0});
  ASSERT_TRUE(ray);
  EXPECT_NEAR(ray->x(), 1.0, 1e-12);
  EXPECT_NEAR(ray->y(), -1.0, 1e-12);
}

TEST(Undistort, InvertsTheLensOverTheWholeImage) {
  Camera camera = kinect();
  for (const std::array<double, 5>& dist : {std::array{-0.29, 0.11, 0.0, 0.0, 0.0},
                                            std::array{0.2624, -0.9531, -0.0054, 0.0026, 1.1633},
                                            std::array{0.05, 0.0, 0.01, -0.01, 0.0}}) {
    camera.dist = dist;
    for (double v = 0.0; v < 480.0; v += 24.0) {
      for (double u = 0.0; u < 640.0; u += 32.0) {
        const std::optional<Eigen::Vector2d> ray = undistort(camera, {u, v});
        ASSERT_TRUE(ray) << u << ", " << v;
        EXPECT_LT((distort(camera, *ray) - Eigen::Vector2d(u, v)).norm(), 1e-5);
      }
    }
  }
}

TEST(Undistort, FollowsTheModelAsOpencvWritesIt) {
  // x = 0.5, y = 0.25, r2 = 0.3125, worked by hand.
  Camera camera = kinect();
  camera.fx = camera.fy = 1.0;
  camera.cx = camera.cy = 0.0;
  camera.dist = {0.1, 0.01, 0.001, 0.002, 0.003};
  const double radial = 1.0 + 0.1 * 0.3125 + 0.01 * 0.09765625 + 0.003 * 0.030517578125;
  const double x = 0.5 * radial + 2.0 * 0.001 * 0.125 + 0.002 * (0.3125 + 2.0 * 0.25);
  const double y = 0.25 * radial + 0.001 * (0.3125 + 2.0 * 0.0625) + 2.0 * 0.002 * 0.125;
  EXPECT_NEAR(distort(camera, {0.5, 0.25}).x(), x, 1e-15);
  EXPECT_NEAR(distort(camera, {0.5, 0.25}).y(), y, 1e-15);
}

TEST(Undistort, HasNoAnswerWhereTheModelFoldsOver) {
  Camera camera = kinect();
  camera.dist = {-0.5, 0.0, 0.0, 0.0, 0.0};  // its radius turns back at 0.816, where it is 0.544
  EXPECT_FALSE(undistort(camera, {319.5 + 0.7 * 525.0, 239.5}));
  EXPECT_TRUE(undistort(camera, {319.5 + 0.5 * 525.0, 239.5}));
}

Camera curved() {
  Camera camera = kinect();
  camera.fx = camera.fy = 600.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.dist = {-0.25, 0.0, 0.0, 0.0, 0.0};
  return camera;
}

TEST(Undistort, IsExactToTheLastDigitsForTheWorkedVector) {
  const std::optional<Eigen::Vector2d> uv = project(curved(), {0.3, -0.2, 1.0});
  ASSERT_TRUE(uv);
  EXPECT_NEAR(uv->x(), 494.15, 1e-10);
  EXPECT_NEAR(uv->y(), 123.9, 1e-10);
  const std::optional<Eigen::Vector2d> ray = undistort(curved(), *uv);
  ASSERT_TRUE(ray);
  EXPECT_LT((*ray - Eigen::Vector2d(0.3, -0.2)).norm(), 1e-12);
}

TEST(Undistort, EndsWhereTheRadiusTurnsBack) {
  const double fold = 0.769800358919501, fold_ray = 1.154700538379252;
  const auto seen = [](double radius) {
    return undistort(curved(), Eigen::Vector2d(320.0 + 600.0 * radius, 240.0));
  };
  EXPECT_FALSE(seen(fold + 1e-6));
  const std::optional<Eigen::Vector2d> ray = seen(fold - 1e-6);
  ASSERT_TRUE(ray);
  EXPECT_LT(ray->x(), fold_ray);
  EXPECT_GT(ray->x(), fold_ray - 0.01);
  EXPECT_TRUE(inside_lens_model(curved(), {fold_ray - 1e-9, 0.0}));
  EXPECT_FALSE(inside_lens_model(curved(), {fold_ray + 1e-9, 0.0}));
  EXPECT_FALSE(project(curved(), {1.2, 0.0, 1.0})) << "it would come back into the image";
}

TEST(Undistort, FindsAFoldThatHigherTermsMake) {
  Camera camera = kinect();
  camera.dist = {0.4, -0.5, 0.0, 0.0, 0.2};  // q = 1 + 1.2 s - 2.5 s^2 + 1.4 s^3 stays positive
  EXPECT_TRUE(inside_lens_model(camera, {3.0, 0.0}));
  camera.dist[4] = 0.1;  // it dips below zero and comes back
  EXPECT_TRUE(inside_lens_model(camera, {0.9, 0.0}));
  EXPECT_FALSE(inside_lens_model(camera, {3.0, 0.0}));
}

TEST(Undistort, WorksWhereRowsRunUpwards) {
  Camera camera = curved();
  camera.fy = -600.0;
  const std::optional<Eigen::Vector2d> uv = project(camera, {0.3, -0.2, 1.0});
  ASSERT_TRUE(uv);
  EXPECT_NEAR(uv->y(), 480.0 - 123.9, 1e-10);
  EXPECT_LT((*undistort(camera, *uv) - Eigen::Vector2d(0.3, -0.2)).norm(), 1e-12);
}

TEST(DistortWithSlope, AgreesWithDifferences) {
  Camera camera = kinect();
  camera.dist = {-0.2, 0.05, 0.003, -0.002, 0.01};
  const Eigen::Vector2d ray(0.31, -0.22);
  const LensPoint point = distort_with_slope(camera, ray);
  EXPECT_LT((point.uv - distort(camera, ray)).norm(), 1e-12);
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    const Eigen::Vector2d slope =
        (distort(camera, ray + step) - distort(camera, ray - step)) / (2.0 * kStep);
    EXPECT_LT((point.duv_dray.col(axis) - slope).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace landmarkdb
