#include "datasets/depth_camera.hpp"

#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "datasets/sensor_poses.hpp"
#include "datasets/shapes/shapes.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr Camera kSmall = {
    .width = 160, .height = 120, .fx = 131, .fy = 131, .cx = 79.5, .cy = 59.5};

// A wall across the view, `distance_m` ahead of a camera at the origin.
Place wall_ahead(double distance_m) {
  Place place;
  add_quad(place.mesh,
           {-20, 20, distance_m},
           {20, 20, distance_m},
           {20, -20, distance_m},
           {-20, -20, distance_m});
  place.caster = std::make_shared<RayCaster>(place.mesh);
  return place;
}

const Place& office() {
  static const Place place = make_place({.type = PlaceType::kOffice, .seed = 3, .size = 0.6});
  return place;
}

TEST(RenderDepth, PutsPointsOnTheSurfacesSeenWhenCarriedByTheTruePose) {
  DepthCameraOptions options{.camera = kSmall, .noise_scale = 0.0, .quantise = false};
  for (const Eigen::Isometry3d& T : sample_camera_poses(office(), 3, 5)) {
    const DepthFrame frame = render_depth(office(), T, options, {});
    ASSERT_GT(frame.valid, 2'000U);
    const Eigen::Vector3f eye = T.translation().cast<float>();
    for (const Eigen::Vector3f& p : frame.cloud.points) {
      if (!p.allFinite()) continue;
      const Eigen::Vector3f q = (T * p.cast<double>()).cast<float>();
      const auto hit = office().caster->first_hit(eye, (q - eye).normalized(), 100.0F);
      ASSERT_TRUE(hit);
      ASSERT_NEAR(hit->distance_m, (q - eye).norm(), 0.002);
    }
  }
}

TEST(RenderDepth, SpreadsDepthAsItsNoiseSays) {
  for (const double z : {1.0, 2.0, 4.0}) {
    const DepthFrame frame = render_depth(
        wall_ahead(z), Eigen::Isometry3d::Identity(), {.quantise = false, .grazing_rad = 0.0}, {});
    double sum = 0.0;
    double sum2 = 0.0;
    for (const Eigen::Vector3f& p : frame.cloud.points) {
      if (!p.allFinite()) continue;
      sum += p.z() - z;
      sum2 += (p.z() - z) * (p.z() - z);
    }
    const auto n = static_cast<double>(frame.valid);
    ASSERT_GT(n, 200'000.0);
    const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    EXPECT_NEAR(sum / n, 0.0, 0.01 * sigma + 1e-5);
    EXPECT_NEAR(std::sqrt(sum2 / n), sigma, 0.01 * sigma);
  }
}

TEST(RenderDepth, ReportsDepthsOfWholeEighthsOfAPixel) {
  const DepthFrame frame =
      render_depth(wall_ahead(3.0), Eigen::Isometry3d::Identity(), {.camera = kSmall}, {});
  std::set<float> depths;
  for (const Eigen::Vector3f& p : frame.cloud.points) {
    if (!p.allFinite()) continue;
    depths.insert(p.z());
    const double eighths = 580.0 * 0.075 / p.z() * 8.0;
    ASSERT_NEAR(eighths, std::round(eighths), 1e-3);
  }
  EXPECT_LT(depths.size(), 12U);
}

TEST(RenderDepth, HasHolesBesideAndBehindEdges) {
  Place place = wall_ahead(3.0);
  add_box(place.mesh, at(0.0, 0.0, 1.4), {0.4, 0.4, 0.2});
  place.caster = std::make_shared<RayCaster>(place.mesh);
  const auto holes = [&](const DepthCameraOptions& options) {
    return options.camera.width * options.camera.height -
           render_depth(place, Eigen::Isometry3d::Identity(), options, {}).valid;
  };
  const std::size_t none =
      holes({.camera = kSmall, .shadows = false, .edge_holes = 0.0, .grazing_rad = 0.0});
  const std::size_t shadow = holes({.camera = kSmall, .edge_holes = 0.0, .grazing_rad = 0.0});
  const std::size_t edge = holes({.camera = kSmall, .shadows = false, .edge_holes = 1.0});
  EXPECT_EQ(none, 0U);
  EXPECT_GT(shadow, 50U);
  EXPECT_GT(edge, 50U);
}

TEST(RenderDepth, SeesNothingAtGrazingAngles) {
  Place place;
  add_quad(place.mesh, {-9, 0.2, 0}, {-9, 0.2, 9}, {9, 0.2, 9}, {9, 0.2, 0});  // a floor, y down
  place.caster = std::make_shared<RayCaster>(place.mesh);
  const DepthFrame frame = render_depth(
      place, Eigen::Isometry3d::Identity(), {.camera = kSmall, .grazing_rad = 0.3}, {});
  for (const Eigen::Vector3f& p : frame.cloud.points) {
    if (!p.allFinite()) continue;
    ASSERT_GT(0.2 / p.norm(), std::sin(0.3) * 0.95);
  }
}

TEST(RenderDepth, IsTheSameForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  const Eigen::Isometry3d T = sample_camera_poses(office(), 1, 2)[0];
  RunContext one, three;
  three.threads = 3;
  const auto bytes = [](const DepthFrame& frame) {
    const auto* first = reinterpret_cast<const char*>(frame.cloud.points.data());
    return std::string(first, frame.cloud.size() * sizeof(Eigen::Vector3f));
  };
  const std::string a = bytes(render_depth(office(), T, {.camera = kSmall}, one));
  EXPECT_EQ(a, bytes(render_depth(office(), T, {.camera = kSmall}, three)));
  EXPECT_NE(a, bytes(render_depth(office(), T, {.camera = kSmall, .seed = 2}, one)));
}

TEST(RenderDepth, KnowsWhichFramesSayLittle) {
  const DepthFrame wall =
      render_depth(wall_ahead(2.0), Eigen::Isometry3d::Identity(), {.camera = kSmall}, {});
  EXPECT_NEAR(wall.normal_spread, 0.0, 1e-9);
}

TEST(RenderDepth, TellsUpInTheCameraFrame) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const DepthFrame frame = render_depth(wall_ahead(2.0), T, {.camera = kSmall}, {});
  EXPECT_LT((T.linear() * frame.up_camera - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(RenderDepth, RefusesCamerasThatCannotBe) {
  const Place place = wall_ahead(2.0);
  const auto T = Eigen::Isometry3d::Identity();
  EXPECT_THROW(render_depth(place, T, {.camera = {}}, {}), Error);
  EXPECT_THROW(render_depth(place, T, {.camera = {.width = 100'000, .height = 100'000}}, {}),
               Error);
  EXPECT_THROW(render_depth(place, T, {.camera = {.width = 10, .height = 10}}, {}), Error);
  Camera bent = kSmall;
  bent.dist[0] = 0.1;
  EXPECT_THROW(render_depth(place, T, {.camera = bent}, {}), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
