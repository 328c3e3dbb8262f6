#include "datasets/picture/render_views.hpp"

#include <gtest/gtest.h>

#include "datasets/depth_camera.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

bool is_orange(const Colour& c) { return c.x() > 0.6F && c.y() < 0.6F && c.z() < 0.25F; }

class RenderViews : public ::testing::Test {
 protected:
  RenderViews() {
    scan_ = merge_stations(scan_place(place_, {.points = 20'000}, {}));
    T_ = sample_camera_poses(place_, 1, 3)[0];
    query_ =
        render_depth(
            place_,
            T_,
            {.camera = {.width = 80, .height = 60, .fx = 66, .fy = 66, .cx = 39.5, .cy = 29.5}},
            {})
            .cloud;
  }
  Place place_ = make_place({.type = PlaceType::kOffice, .seed = 2, .size = 0.5, .stations = 2});
  PointCloud scan_, query_;
  Eigen::Isometry3d T_;
};

TEST_F(RenderViews, ShowsTheQueryInBothViews) {
  const Canvas canvas = render_views(scan_, query_, T_, {.width_px = 600});
  EXPECT_EQ(canvas.width, 600);
  int left = 0;
  int right = 0;
  for (int y = 0; y < canvas.height - 60; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      if (!is_orange(canvas.pixels[static_cast<std::size_t>(y * canvas.width + x)])) continue;
      ++(x < canvas.width / 2 ? left : right);
    }
  }
  EXPECT_GT(left, 100);
  EXPECT_GT(right, 100);
}

TEST_F(RenderViews, DrawsThePlaceAloneWithoutAQuery) {
  const Canvas canvas = render_views(scan_, {}, Eigen::Isometry3d::Identity(), {.width_px = 600});
  int orange = 0;
  int drawn = 0;
  for (const Colour& pixel : canvas.pixels) {
    orange += is_orange(pixel) ? 1 : 0;
    drawn += pixel.x() < 0.97F ? 1 : 0;
  }
  EXPECT_EQ(orange, 0);
  EXPECT_GT(drawn, canvas.width * canvas.height / 10);
}

TEST_F(RenderViews, StacksTheViewsWhenAsked) {
  const Canvas beside = render_views(scan_, query_, T_, {.width_px = 600});
  const Canvas stacked =
      render_views(scan_, query_, T_, {.width_px = 600, .layout = Layout::kStacked});
  EXPECT_GT(stacked.height, beside.height);
}

TEST_F(RenderViews, RefusesWhatItCannotDraw) {
  EXPECT_THROW(render_views({}, query_, T_, {}), Error);
  EXPECT_THROW(render_views(scan_, query_, T_, {.width_px = 100}), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
