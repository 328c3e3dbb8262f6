#include "server/convert_explanation.hpp"

#include <gtest/gtest.h>

#include "client/convert.hpp"

namespace landmarkdb {
namespace {

Explanation full() {
  Explanation explanation;
  explanation.funnel = {{"points", 100}, {"used", 90}};
  explanation.scenes.push_back({.scene = "lobby", .steps = {{"putative", 7}}, .best_quality = 0.5});
  ExplainedCandidate& candidate = explanation.candidates.emplace_back();
  candidate.scene = "lobby";
  candidate.role = CandidateRole::kRival;
  for (int i = 0; i < 16; ++i) candidate.T_scene_sensor(i / 4, i % 4) = i;
  candidate.confidence = 0.11;
  candidate.quality = 0.12;
  candidate.overlap = 0.13;
  candidate.explained = 0.14;
  candidate.crossed = 0.15;
  candidate.coverage = 0.16;
  candidate.observability = 0.17;
  candidate.margin = 0.18;
  candidate.deviation << 1, 2, 3, 4, 5, 6;
  candidate.distance_m = 12.5;
  candidate.terms = {{.name = "margin", .value = 0.18, .ideal = 1.0, .worth = 2.0, .cost = 4.0}};
  explanation.lost_at = "verify";
  explanation.why = "because";
  explanation.remedies = {{.option = "--scene", .value = "lobby", .effect = "localized"}};
  return explanation;
}

// What the server writes is what its client reads.
TEST(ExplanationOnTheWire, ArrivesAsItLeft) {
  const Explanation sent = full();
  const Explanation got = client::from_proto(to_proto(sent));
  ASSERT_EQ(got.funnel.size(), 2U);
  EXPECT_EQ(got.funnel[1].name, "used");
  EXPECT_EQ(got.funnel[1].count, 90U);
  ASSERT_EQ(got.scenes.size(), 1U);
  EXPECT_EQ(got.scenes[0].scene, "lobby");
  EXPECT_EQ(got.scenes[0].steps.at(0).count, 7U);
  EXPECT_EQ(got.scenes[0].best_quality, 0.5);
  ASSERT_EQ(got.candidates.size(), 1U);
  const ExplainedCandidate& a = sent.candidates[0];
  const ExplainedCandidate& b = got.candidates[0];
  EXPECT_EQ(b.scene, a.scene);
  EXPECT_EQ(b.role, a.role);
  EXPECT_EQ(b.T_scene_sensor, a.T_scene_sensor);
  EXPECT_EQ(b.confidence, a.confidence);
  EXPECT_EQ(b.quality, a.quality);
  EXPECT_EQ(b.overlap, a.overlap);
  EXPECT_EQ(b.explained, a.explained);
  EXPECT_EQ(b.crossed, a.crossed);
  EXPECT_EQ(b.coverage, a.coverage);
  EXPECT_EQ(b.observability, a.observability);
  EXPECT_EQ(b.margin, a.margin);
  EXPECT_EQ(b.deviation, a.deviation);
  EXPECT_EQ(b.distance_m, a.distance_m);
  EXPECT_FALSE(b.turn_rad);
  ASSERT_EQ(b.terms.size(), 1U);
  EXPECT_EQ(b.terms[0].name, "margin");
  EXPECT_EQ(b.terms[0].value, 0.18);
  EXPECT_EQ(b.terms[0].ideal, 1.0);
  EXPECT_EQ(b.terms[0].worth, 2.0);
  EXPECT_EQ(b.terms[0].cost, 4.0);
  EXPECT_EQ(got.lost_at, "verify");
  EXPECT_EQ(got.why, "because");
  ASSERT_EQ(got.remedies.size(), 1U);
  EXPECT_EQ(got.remedies[0].option, "--scene");
  EXPECT_EQ(got.remedies[0].value, "lobby");
  EXPECT_EQ(got.remedies[0].effect, "localized");
}

TEST(ExplanationOnTheWire, IsRefusedByTheClientWhenAnArrayHasAnotherLength) {
  v1::Explanation message = to_proto(full());
  message.mutable_candidates(0)->add_deviation(7.0);
  EXPECT_THROW(client::from_proto(message), Error);
  message = to_proto(full());
  message.mutable_candidates(0)->clear_t_scene_sensor();
  EXPECT_THROW(client::from_proto(message), Error);
}

TEST(SceneViewOnTheWire, ArrivesAsItLeftFarFromZero) {
  SceneView sent;
  sent.points = {{0, 0, 0}, {1, 2, 3}, {10, 0, -4}};
  sent.origin = {500'000.125, 5'000'000.25, 3.0};
  sent.scene_points = 99;
  sent.spacing_m = 0.05;
  sent.whole = true;
  sent.up = Eigen::Vector3d::UnitZ();
  const SceneView got = client::from_proto(to_proto(sent));
  ASSERT_EQ(got.points.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((got.points[i] - sent.points[i]).norm(), 1e-3);
  EXPECT_EQ(got.origin, sent.origin);
  EXPECT_EQ(got.scene_points, 99U);
  EXPECT_EQ(got.spacing_m, 0.05);
  EXPECT_TRUE(got.whole);
  EXPECT_EQ(got.up, sent.up);
}

TEST(SceneViewOnTheWire, IsRefusedByTheClientWhenItsLengthIsWrong) {
  SceneView view;
  view.points = {{0, 0, 0}, {1, 2, 3}};
  v1::SceneView message = to_proto(view);
  message.mutable_cloud()->set_points(3);
  EXPECT_THROW(client::from_proto(message), Error);
  message = to_proto(view);
  message.mutable_cloud()->set_encoding(v1::POINT_ENCODING_FLOAT32);
  EXPECT_THROW(client::from_proto(message), Error);
  message = to_proto(view);
  message.mutable_cloud()->set_zstd(true);
  EXPECT_THROW(client::from_proto(message), Error);
}

}  // namespace
}  // namespace landmarkdb
