#include <gmock/gmock.h>

#include "client/convert.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename Repeated>
void fill(Repeated* numbers, int count, double first) {
  for (int i = 0; i < count; ++i) numbers->Add(first + i);
}

v1::QueryResult full_answer() {
  v1::QueryResult answer;
  answer.set_status(v1::QUERY_STATUS_LOCALIZED);
  v1::Hypothesis& h = *answer.add_hypotheses();
  h.set_scene("lobby");
  h.set_scene_version(4);
  h.set_confidence(0.75);
  fill(h.mutable_t_scene_sensor(), 16, 0.0);
  fill(h.mutable_chain()->mutable_t_landmark_sensor(), 16, 100.0);
  fill(h.mutable_chain()->mutable_t_scene_landmark(), 16, 200.0);
  fill(h.mutable_chain()->mutable_t_icp(), 16, 300.0);
  h.mutable_chain()->set_scale(1.5);
  h.mutable_correspondences()->set_after_slope(12);
  h.mutable_fit()->set_margin(0.25);
  fill(h.mutable_covariance(), 36, 0.0);
  answer.mutable_query()->set_seed(9);
  answer.mutable_query()->set_points_used(77);
  answer.add_warnings("planar_scene");
  answer.mutable_timing()->set_verify_ms(1.25);
  answer.mutable_timing()->set_total_ms(2.5);
  v1::Correspondence& pair = *answer.add_correspondences();
  pair.mutable_scene_m()->set_y(2.0);
  pair.set_dropped_by("ratio");
  return answer;
}

TEST(QueryResultFromProto, ReadsMatricesRowByRow) {
  const QueryResult result = from_proto(full_answer());
  ASSERT_EQ(result.hypotheses.size(), 1U);
  const Hypothesis& h = result.hypotheses.front();
  EXPECT_EQ(h.T_scene_sensor(0, 3), 3.0);
  EXPECT_EQ(h.T_scene_sensor(2, 1), 9.0);
  EXPECT_EQ(h.chain.T_landmark_sensor(1, 0), 104.0);
  EXPECT_EQ(h.chain.T_scene_landmark(1, 0), 204.0);
  EXPECT_EQ(h.chain.T_icp(1, 0), 304.0);
  EXPECT_EQ(h.covariance(1, 0), 6.0);
}

TEST(QueryResultFromProto, ReadsTheRest) {
  const QueryResult result = from_proto(full_answer());
  EXPECT_EQ(result.status, QueryStatus::kLocalized);
  EXPECT_EQ(result.hypotheses[0].scene, "lobby");
  EXPECT_EQ(result.hypotheses[0].scene_version, 4);
  EXPECT_FALSE(result.hypotheses[0].landmark);
  EXPECT_EQ(result.hypotheses[0].chain.scale, 1.5);
  EXPECT_EQ(result.hypotheses[0].counts.after_slope, 12U);
  EXPECT_EQ(result.hypotheses[0].fit.margin, 0.25);
  EXPECT_EQ(result.seed, 9U);
  EXPECT_EQ(result.query.points_used, 77U);
  EXPECT_THAT(result.warnings, ElementsAre("planar_scene"));
  EXPECT_EQ(result.timings.verify.count(), 1.25);
  EXPECT_EQ(result.timings.total.count(), 2.5);
  EXPECT_EQ(result.correspondences.at(0).scene_m.y(), 2.0);
  EXPECT_EQ(result.correspondences.at(0).dropped_by, "ratio");
}

void expect_refused(const v1::QueryResult& answer, const std::string& word) {
  try {
    from_proto(answer);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInternal);
    EXPECT_THAT(error.what(), HasSubstr(word));
  }
}

TEST(QueryResultFromProto, RefusesArraysOfAnotherLength) {
  v1::QueryResult answer = full_answer();
  answer.mutable_hypotheses(0)->mutable_t_scene_sensor()->RemoveLast();
  expect_refused(answer, "t_scene_sensor has 15 numbers, want 16");
  answer = full_answer();
  answer.mutable_hypotheses(0)->mutable_covariance()->Add(0.0);
  expect_refused(answer, "covariance has 37 numbers, want 36");
}

TEST(QueryResultFromProto, RefusesAStatusThatSaysNothing) {
  v1::QueryResult answer = full_answer();
  answer.clear_status();
  expect_refused(answer, "status 0");
  answer = full_answer();
  answer.clear_hypotheses();
  expect_refused(answer, "no hypothesis");
}

TEST(SceneInfoFromProto, ReadsStateTagsLandmarksAndVersions) {
  v1::SceneInfo wire;
  wire.set_name("lobby");
  wire.set_kind(v1::ENTRY_KIND_OBJECT);
  wire.set_state(v1::SCENE_STATE_QUARANTINED);
  wire.set_state_reason("digest of points");
  (*wire.mutable_tags())["floor"] = "2";
  wire.add_landmarks()->set_name("desk");
  wire.mutable_options()->set_keypoints(v1::KEYPOINT_METHOD_NARF);
  wire.add_versions()->set_version(3);
  const SceneInfo scene = from_proto(wire);
  EXPECT_EQ(scene.kind, EntryKind::kObject);
  EXPECT_TRUE(scene.quarantined);
  EXPECT_EQ(scene.state_reason, "digest of points");
  EXPECT_EQ(scene.tags.at("floor"), "2");
  EXPECT_EQ(scene.landmarks.at(0).name, "desk");
  EXPECT_EQ(scene.options.keypoints, KeypointMethod::kNarf);
  EXPECT_EQ(scene.versions.at(0).version, 3);
  EXPECT_FALSE(scene.up);
  EXPECT_FALSE(scene.min_m);
}

TEST(ErrorFromProto, KeepsKnownCodesAndMakesTheOthersUnknown) {
  v1::Error wire;
  wire.set_code(v1::CODE_DATA_LOSS);
  wire.set_message("page 3");
  EXPECT_EQ(from_proto(wire).code(), ErrorCode::kDataLoss);
  EXPECT_STREQ(from_proto(wire).what(), "page 3");
  wire.set_code(static_cast<v1::Code>(99));
  wire.clear_message();
  EXPECT_EQ(from_proto(wire).code(), ErrorCode::kUnknown);
  EXPECT_STRNE(from_proto(wire).what(), "");
}

TEST(HealthFromProto, NamesTheState) {
  v1::HealthReply wire;
  wire.set_status(v1::HEALTH_STATUS_STARTING);
  EXPECT_EQ(from_proto(wire).status, "starting");
  EXPECT_FALSE(from_proto(wire).ready);
}

}  // namespace
}  // namespace landmarkdb::client
