#include "datasets/picture/point_layer.hpp"

#include <gtest/gtest.h>

namespace landmarkdb::datasets {
namespace {

const Colour kWhite(1, 1, 1);

TEST(DrawPoints, ShowsTheNearestOfTwo) {
  Canvas canvas(20, 20, kWhite);
  const std::vector<ViewPoint> points = {{{10, 10}, 1.0F}, {{10, 10}, 0.0F}};
  draw_points(canvas,
              0,
              0,
              20,
              20,
              points,
              {.radius_px = 2.0F, .far = {0, 0, 1}, .near = {1, 0, 0}, .shading = 0.0F});
  EXPECT_NEAR(canvas.at(10, 10).x(), 1.0, 1e-5);
  EXPECT_NEAR(canvas.at(10, 10).z(), 0.0, 1e-5);
}

TEST(DrawPoints, DarkensWhatLiesBehindAStep) {
  std::vector<ViewPoint> points;
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 40; ++y) {
      const Eigen::Vector2f px(static_cast<float>(x), static_cast<float>(y));
      points.push_back({px, x < 20 ? 0.0F : 1.0F});
    }
  }
  Canvas canvas(40, 40, kWhite);
  const Colour grey(0.8F, 0.8F, 0.8F);
  draw_points(canvas, 0, 0, 40, 40, points, {.radius_px = 1.0F, .far = grey, .near = grey});
  EXPECT_LT(canvas.at(18, 20).x(), 0.5F);
  EXPECT_NEAR(canvas.at(5, 20).x(), 0.8F, 1e-4);
  EXPECT_NEAR(canvas.at(30, 20).x(), 0.8F, 1e-4);
}

TEST(DrawPoints, KeepsToItsPanel) {
  Canvas canvas(20, 20, kWhite);
  const std::vector<ViewPoint> points = {{{15, 5}, 0.0F}, {{1e20F, 5}, 0.0F}, {{-3, -3}, 0.0F}};
  draw_points(
      canvas, 5, 5, 10, 10, points, {.radius_px = 3.0F, .far = {0, 0, 0}, .near = {0, 0, 0}});
  EXPECT_EQ(canvas.at(18, 10), kWhite);
  EXPECT_EQ(canvas.at(3, 3), kWhite);
}

}  // namespace
}  // namespace landmarkdb::datasets
