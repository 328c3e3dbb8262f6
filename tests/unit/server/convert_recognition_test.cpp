#include "server/convert_recognition.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/convert_recognition.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

v1::Camera camera() {
  v1::Camera message;
  message.set_width(640);
  message.set_height(480);
  message.set_fx(600);
  message.set_fy(-600);
  message.set_cx(320);
  message.set_cy(240);
  return message;
}

template <typename Message>
std::string field_of(const Message& message) {
  try {
    from_proto(message);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.field();
  }
  return "it was taken";
}

TEST(ConvertRecognition, TakesACameraWithAndWithoutALens) {
  EXPECT_EQ(from_proto(camera()).dist[0], 0.0);
  v1::Camera lens = camera();
  for (const double k : {-0.2, 0.1, 0.0, 0.0, 0.01}) lens.add_dist(k);
  EXPECT_EQ(from_proto(lens).dist[4], 0.01);
  EXPECT_EQ(from_proto(lens).fy, -600.0);
}

TEST(ConvertRecognition, RefusesCamerasThatCannotBe) {
  const auto spoiled = [](const auto& spoil) {
    v1::Camera message = camera();
    spoil(message);
    return field_of(message);
  };
  EXPECT_EQ(spoiled([](auto& c) { c.set_width(0); }), "camera.width");
  EXPECT_EQ(spoiled([](auto& c) { c.set_height(4'000'000'000U); }), "camera.height");
  EXPECT_EQ(spoiled([](auto& c) { c.set_fx(0); }), "camera.fx");
  EXPECT_EQ(spoiled([](auto& c) { c.set_fy(NAN); }), "camera.fy");
  EXPECT_EQ(spoiled([](auto& c) { c.set_cx(INFINITY); }), "camera.cx");
  EXPECT_EQ(spoiled([](auto& c) { c.add_dist(1); }), "camera.dist");
}

TEST(ConvertRecognition, RefusesOptionsOutOfRange) {
  const auto spoiled = [](const auto& spoil) {
    v1::RecognizeOptions message;
    spoil(message);
    return field_of(message);
  };
  EXPECT_EQ(spoiled([](auto& o) { o.set_top(0); }), "options.top");
  EXPECT_EQ(spoiled([](auto& o) { o.set_top(101); }), "options.top");
  EXPECT_EQ(spoiled([](auto& o) { o.set_min_confidence(NAN); }), "options.min_confidence");
  EXPECT_EQ(spoiled([](auto& o) { o.set_min_depth_m(-1); }), "options.min_depth_m");
  EXPECT_EQ(spoiled([](auto& o) { o.set_min_depth_m(30); }), "options.max_depth_m");
  EXPECT_EQ(from_proto(v1::RecognizeOptions{}).top, 3U);
}

TEST(ConvertRecognition, RefusesPointsThatCannotBe) {
  const Camera seen = from_proto(camera());
  v1::ImagePoints points;
  v1::ImagePoint& point = *points.add_points();
  point.set_u(1);
  EXPECT_THAT(from_proto(points, seen).points, SizeIs(1));
  EXPECT_EQ(from_proto(points, seen).points[0].type, FeatureType::kVertex);
  EXPECT_EQ(from_proto(points, seen).width, 640U);
  point.set_v(NAN);
  EXPECT_THROW(from_proto(points, seen), Error);
  point.set_v(2);
  point.set_type(static_cast<v1::FeatureType>(9));
  EXPECT_THROW(from_proto(points, seen), Error);
  point.set_type(v1::FEATURE_TYPE_CENTROID);
  points.add_links(0);
  EXPECT_THROW(from_proto(points, seen), Error);  // half a link
  points.add_links(1);
  EXPECT_THROW(from_proto(points, seen), Error);  // to a point that is not there
}

TEST(ConvertRecognition, WhatAClientSendsArrivesAsItWas) {
  client::RecognizeInput input;
  input.camera.width = 4;
  input.camera.height = 3;
  input.camera.fx = input.camera.fy = 5.0;
  input.camera.dist = {0.1, 0.2, 0.3, 0.4, 0.5};
  input.points = {{FeatureType::kInflexion, {1.5, 2.5}, {0.1, 0.2}},
                  {FeatureType::kVertex, {0, 1}, {}}};
  input.links = {{0, 1}};
  RecognizeOptions options;
  options.models = {"box"};
  options.seed = 7;
  options.max_depth_m = 3.0;
  const v1::RecognizeRequest request = client::to_proto(input, options);
  const Camera seen = from_proto(request.camera());
  EXPECT_EQ(seen.dist, input.camera.dist);
  const ImageFeatures features = from_proto(request.points(), seen);
  EXPECT_EQ(features.points[0].type, FeatureType::kInflexion);
  EXPECT_EQ(features.points[0].uv, Eigen::Vector2d(1.5, 2.5));
  EXPECT_THAT(features.points[0].directions, ElementsAre(0.1, 0.2));
  EXPECT_THAT(features.links, ElementsAre(ElementsAre(0, 1)));
  EXPECT_THAT(from_proto(request.options()).models, ElementsAre("box"));
  EXPECT_EQ(from_proto(request.options()).max_depth_m, 3.0);
}

TEST(ConvertRecognition, AnAnswerArrivesAsItWasGiven) {
  RecognizeResult result;
  result.status = RecognizeStatus::kRecognized;
  result.image_points = 12;
  result.seed = 77;
  result.warnings = {"search_cut_short"};
  MonoHypothesis hypothesis;
  hypothesis.model = "box";
  hypothesis.confidence = 0.9;
  hypothesis.T_camera_object.translation() = Eigen::Vector3d(1, 2, 3);
  hypothesis.covariance(1, 2) = 0.5;
  hypothesis.ambiguous = true;
  hypothesis.symmetry = "c4";
  hypothesis.pairs = {{1, 2, 0.25}};
  result.hypotheses = {hypothesis};
  const RecognizeResult seen = client::from_proto(to_proto(result)).result;
  EXPECT_EQ(seen.status, RecognizeStatus::kRecognized);
  EXPECT_EQ(seen.image_points, 12U);
  EXPECT_EQ(seen.seed, 77U);
  EXPECT_THAT(seen.warnings, ElementsAre("search_cut_short"));
  ASSERT_THAT(seen.hypotheses, SizeIs(1));
  EXPECT_EQ(seen.hypotheses[0].T_camera_object.matrix(), hypothesis.T_camera_object.matrix());
  EXPECT_EQ(seen.hypotheses[0].covariance, hypothesis.covariance);
  EXPECT_TRUE(seen.hypotheses[0].ambiguous);
  EXPECT_EQ(seen.hypotheses[0].pairs[0].residual_px, 0.25);
  EXPECT_THROW(client::from_proto(v1::RecognizeResult{}), Error);
}

}  // namespace
}  // namespace landmarkdb
