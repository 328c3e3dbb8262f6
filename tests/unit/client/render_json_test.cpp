#include "client/render_json.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;
using Json = nlohmann::ordered_json;

Hypothesis some_hypothesis() {
  Hypothesis h;
  h.scene = "lobby";
  h.confidence = 0.1 + 0.2;  // a number that needs all its digits
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).matrix();
  T.translation() = Eigen::Vector3d(1.0 / 3.0, 2.0, 3.0);
  h.T_scene_sensor = T.matrix();
  h.chain.T_landmark_sensor = T.matrix();
  h.counts.after_slope = 8;
  h.covariance(0, 5) = 1e-7;
  return h;
}

QueryResult some_result() {
  QueryResult result;
  result.status = QueryStatus::kLocalized;
  result.hypotheses = {some_hypothesis()};
  result.query.points = 1000;
  result.seed = 3;
  result.warnings = {"planar_scene"};
  result.timings.total = StageTimings::Duration(12.5);
  return result;
}

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& item : object.items()) out.push_back(item.key());
  return out;
}

TEST(QueryJson, HasTheDocumentedKeysInTheDocumentedOrder) {
  const Json json = query_json(some_result());
  EXPECT_THAT(keys(json), ElementsAre("status", "hypotheses", "query", "warnings", "timing_ms"));
  EXPECT_THAT(keys(json["hypotheses"][0]),
              ElementsAre("scene",
                          "landmark",
                          "confidence",
                          "T_scene_sensor",
                          "translation_m",
                          "rotation_xyzw",
                          "roll_pitch_yaw_deg",
                          "chain",
                          "correspondences",
                          "fit",
                          "covariance",
                          "rival",
                          "scene_version"));
  EXPECT_THAT(keys(json["hypotheses"][0]["chain"]),
              ElementsAre("T_landmark_sensor", "T_scene_landmark", "T_icp", "scale"));
  EXPECT_THAT(
      keys(json["hypotheses"][0]["correspondences"]),
      ElementsAre("putative", "after_ratio", "after_slope", "after_consistency", "inliers"));
  EXPECT_THAT(keys(json["hypotheses"][0]["fit"]),
              ElementsAre("overlap",
                          "rmse_m",
                          "free_space_violation",
                          "margin",
                          "observability",
                          "explained",
                          "coverage",
                          "quality",
                          "contrast",
                          "contradicted",
                          "refuted",
                          "agreeing"));
  EXPECT_THAT(
      keys(json["query"]),
      ElementsAre("points", "points_used", "invalid", "keypoints", "density_ratio", "seed"));
  EXPECT_THAT(keys(json["timing_ms"]),
              ElementsAre("load",
                          "preprocess",
                          "keypoints",
                          "describe",
                          "match",
                          "filter",
                          "pose",
                          "icp",
                          "verify",
                          "total"));
}

TEST(QueryJson, WritesTransformsRowByRowAndAnglesInDegrees) {
  const Json h = query_json(some_result())["hypotheses"][0];
  ASSERT_EQ(h["T_scene_sensor"].size(), 16U);
  EXPECT_NEAR(h["T_scene_sensor"][1].get<double>(), -1.0, 1e-15);
  EXPECT_EQ(h["T_scene_sensor"][3].get<double>(), 1.0 / 3.0);
  EXPECT_EQ(h["translation_m"][0].get<double>(), 1.0 / 3.0);
  EXPECT_NEAR(h["rotation_xyzw"][2].get<double>(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(h["rotation_xyzw"][3].get<double>(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(h["roll_pitch_yaw_deg"][2].get<double>(), 90.0, 1e-9);
  EXPECT_EQ(h["covariance"][5].get<double>(), 1e-7);
}

TEST(QueryJson, NumbersReadBackToTheSameDouble) {
  const QueryResult result = some_result();
  const Json read = Json::parse(dump(query_json(result)));
  EXPECT_EQ(read["hypotheses"][0]["confidence"].get<double>(), result.hypotheses[0].confidence);
  const auto numbers = to_row_major(result.hypotheses[0].T_scene_sensor);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(read["hypotheses"][0]["T_scene_sensor"][i].get<double>(), numbers[i]);
  }
}

TEST(QueryJson, TakesTheRotationOutOfASimilarity) {
  QueryResult result = some_result();
  result.hypotheses[0].T_scene_sensor.topLeftCorner<3, 3>() *= 2.0;
  const Json h = query_json(result)["hypotheses"][0];
  EXPECT_NEAR(h["roll_pitch_yaw_deg"][2].get<double>(), 90.0, 1e-9);
  EXPECT_NEAR(h["T_scene_sensor"][4].get<double>(), 2.0, 1e-12);
}

TEST(QueryJson, GivesTheReasonOnlyWhereNothingWasFound) {
  QueryResult result;
  result.reason = "match: no pair passed the ratio filter";
  const Json json = query_json(result);
  EXPECT_THAT(keys(json),
              ElementsAre("status", "reason", "hypotheses", "query", "warnings", "timing_ms"));
  EXPECT_EQ(json["status"], "not_found");
  EXPECT_EQ(json["hypotheses"], Json::array());
  EXPECT_FALSE(query_json(some_result()).contains("reason"));
}

TEST(QueryJson, NamesTheLandmarkOrNull) {
  QueryResult result = some_result();
  EXPECT_TRUE(query_json(result)["hypotheses"][0]["landmark"].is_null());
  result.hypotheses[0].landmark = "air-vents";
  EXPECT_EQ(query_json(result)["hypotheses"][0]["landmark"], "air-vents");
}

TEST(Dump, SurvivesNamesThatAreNotUtf8) {
  QueryResult result = some_result();
  result.hypotheses[0].scene = "caf\xe9";
  EXPECT_NO_THROW(Json::parse(dump(query_json(result))));
}

TEST(QueryExitStatus, FollowsTheStatus) {
  EXPECT_EQ(query_exit_status(QueryStatus::kLocalized), 0);
  EXPECT_EQ(query_exit_status(QueryStatus::kNotFound), 3);
  EXPECT_EQ(query_exit_status(QueryStatus::kAmbiguous), 4);
}

}  // namespace
}  // namespace landmarkdb::client
