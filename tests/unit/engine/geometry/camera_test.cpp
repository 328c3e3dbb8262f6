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

}  // namespace
}  // namespace landmarkdb
