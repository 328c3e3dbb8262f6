#include "datasets/mono/render_model.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "engine/mono/find_features.hpp"

namespace landmarkdb::datasets {
namespace {

MonoModel box(double x, double y, double z) {
  MonoModel model;
  model.name = "box";
  for (const double cx : {-x, x}) {
    for (const double cy : {-y, y}) {
      for (const double cz : {-z, z}) model.points.push_back({FeatureType::kVertex, {cx, cy, cz}});
    }
  }
  model.faces = {
      {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  return model;
}

Camera camera() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = c.fy = 600.0;
  c.cx = 320.0;
  c.cy = 240.0;
  c.dist = {-0.25, 0.0, 0.0, 0.0, 0.0};
  return c;
}

Eigen::Isometry3d pose(const Eigen::Vector3d& turn, const Eigen::Vector3d& t) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector(turn);
  T.translation() = t;
  return T;
}

// How far the nearest feature of the type is from where the camera sees a place of the object.
double nearest(const ImageFeatures& features,
               FeatureType type,
               const Camera& c,
               const Eigen::Vector3d& place) {
  const Eigen::Vector2d uv = distort(c, place.head<2>() / place.z());
  double best = 1e9;
  for (const ImageFeature& point : features.points) {
    if (point.type == type) best = std::min(best, (point.uv - uv).norm());
  }
  return best;
}

TEST(RenderModel, PutsCornersWhereTheCameraSeesThem) {
  const Camera c = camera();
  const MonoModel model = box(0.1, 0.08, 0.06);
  FeatureSearchOptions options;
  options.camera = c;
  int seen = 0;
  for (int round = 0; round < 4; ++round) {
    const Eigen::Isometry3d T =
        pose({0.5 + 0.2 * round, -0.6, 0.4 * round}, {0.1 - 0.1 * round, 0.08, 0.7});
    const ImageFeatures features = find_image_features(
        render_model(model, c, T, {.noise = 1.0, .seed = static_cast<std::uint64_t>(round) + 3}),
        options,
        {});
    for (const ModelFeature& point : model.points) {
      seen += nearest(features, FeatureType::kVertex, c, T * point.xyz) < 0.3 ? 1 : 0;
    }
  }
  EXPECT_GE(seen, 24) << "7 of the 8 corners are seen from most sides";
}

TEST(RenderModel, DrawsCirclesAsDiscsUponTheirFaces) {
  Camera c = camera();
  c.dist = {};
  MonoModel model = box(0.1, 0.1, 0.02);
  model.circles = {{{0.02, 0.01, -0.02}, -Eigen::Vector3d::UnitZ(), 0.04}};
  const Eigen::Isometry3d T = pose({0.0, 0.0, 0.3}, {0.0, 0.0, 0.6});
  const ImageFeatures features =
      find_image_features(render_model(model, c, T, {.noise = 0.0}), {}, {});
  EXPECT_LT(nearest(features, FeatureType::kConicCentre, c, T * model.circles[0].center), 0.1);
}

TEST(RenderModel, HidesWhatLiesBehind) {
  Camera c = camera();
  const MonoModel front = box(0.3, 0.3, 0.01), back = box(0.05, 0.05, 0.05);
  const std::vector<SeenModel> both{{&back, pose({0.3, 0.2, 0.1}, {0.0, 0.0, 1.5})},
                                    {&front, pose({0.0, 0.0, 0.0}, {0.0, 0.0, 0.8})}};
  RenderOptions options;
  options.noise = 0.0;
  const GreyImage with = render_models(both, c, options);
  EXPECT_EQ(with.at(320, 240), with.at(300, 250));
}

TEST(RenderModel, IsTheSamePictureForTheSameSeed) {
  const MonoModel model = box(0.1, 0.1, 0.1);
  const Eigen::Isometry3d T = pose({0.5, 0.4, 0.1}, {0.0, 0.0, 0.8});
  const RenderOptions options{.noise = 3.0, .clutter = 20, .texture = 4.0, .seed = 9};
  const GreyImage a = render_model(model, camera(), T, options);
  EXPECT_EQ(a.pixels, render_model(model, camera(), T, options).pixels);
  RenderOptions other = options;
  other.seed = 10;
  EXPECT_NE(a.pixels, render_model(model, camera(), T, other).pixels);
}

TEST(RenderModel, LeavesOutWhatIsBehindTheCamera) {
  const MonoModel model = box(0.1, 0.1, 0.1);
  const RenderOptions options{.noise = 0.0};
  const GreyImage behind =
      render_model(model, camera(), pose({0, 0, 0}, {0.0, 0.0, -1.0}), options);
  EXPECT_EQ(behind.pixels, render_models({}, camera(), options).pixels);
}

}  // namespace
}  // namespace landmarkdb::datasets
