#include "client/render_explanation.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/render_json.hpp"
#include "client/render_text.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

ExplainedCandidate candidate(CandidateRole role) {
  ExplainedCandidate c;
  c.scene = "floor2";
  c.role = role;
  c.confidence = 0.41;
  c.quality = 0.7;
  c.deviation << 0.01, 0.02, 0.5, 0.001, 0.002, 0.003;
  c.terms = {{.name = "margin", .value = 0.02, .ideal = 1.0, .worth = 0.1, .cost = 5.5},
             {.name = "overlap", .value = 0.93, .ideal = 1.0, .worth = 3.0, .cost = 0.0}};
  return c;
}

Explanation lost() {
  Explanation e;
  e.funnel = {{"points", 307200}, {"used", 250000}, {"keypoints", 800}};
  e.candidates = {candidate(CandidateRole::kBest), candidate(CandidateRole::kRival)};
  e.candidates[1].distance_m = 12.3;
  e.candidates[1].turn_rad = 3.14159265;
  e.lost_at = "verify";
  e.why = "the best pose has confidence 0.41, wanted 0.50";
  e.remedies = {{.option = "--min-confidence", .value = "0.41", .effect = "localized"},
                {.option = "--scene", .value = "floor2", .effect = "localized"},
                {.option = "--up", .value = "", .effect = "localized"}};
  return e;
}

TEST(ExplanationText, TellsTheFunnelTheCandidatesAndWhatWouldHaveHelped) {
  const std::string text = explanation_text(lost());
  EXPECT_THAT(text, AllOf(HasSubstr("307,200"), HasSubstr("keypoints described")));
  EXPECT_THAT(text, HasSubstr("1. best in floor2, confidence 0.41, quality 0.70, overlap 0.00"));
  EXPECT_THAT(text, HasSubstr("12.30 m and 180 deg from the best"));
  EXPECT_THAT(text,
              AllOf(HasSubstr("for      overlap 0.930 (+3.0)\n"),
                    HasSubstr("against  margin 0.020 (-5.5)\n"),
                    HasSubstr("z 0.500 m")));
  EXPECT_THAT(text, HasSubstr("lost at verify: the best pose has confidence 0.41, wanted 0.50"));
  EXPECT_THAT(text, HasSubstr("--min-confidence 0.41 would have accepted it"));
  EXPECT_THAT(text, HasSubstr("--scene 'floor2', where that is known, would have made it"));
  EXPECT_THAT(text, HasSubstr("an --up vector would have removed the rival"));
  EXPECT_EQ(text.back(), '\n');
}

TEST(ExplanationText, ComparesScenesOnlyWhereThereAreSeveral) {
  Explanation e = lost();
  e.scenes = {{.scene = "a", .steps = {{"putative", 5}}, .best_quality = 0.3}};
  EXPECT_THAT(explanation_text(e), Not(HasSubstr("scene by scene")));
  e.scenes.push_back({.scene = "b\x1b[2J", .steps = {{"putative", 4}}, .best_quality = 0.0});
  const std::string text = explanation_text(e);
  EXPECT_THAT(text, AllOf(HasSubstr("scene by scene"), HasSubstr("0.30"), HasSubstr("putative")));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(ExplanationText, StandsInTheAnswerOnlyWhereItWasAskedFor) {
  QueryResult result;
  EXPECT_THAT(query_text(result), Not(HasSubstr("what each step left")));
  EXPECT_FALSE(query_json(result).contains("explain"));
  result.explanation = lost();
  EXPECT_THAT(query_text(result), HasSubstr("what each step left"));
  EXPECT_TRUE(query_json(result).contains("explain"));
}

TEST(ExplanationJson, HoldsEveryFigure) {
  const nlohmann::ordered_json json = explanation_json(lost());
  EXPECT_EQ(json["funnel"][1]["step"], "used");
  EXPECT_EQ(json["funnel"][1]["left"], 250000);
  EXPECT_EQ(json["candidates"][0]["role"], "best");
  EXPECT_EQ(json["candidates"][0]["T_scene_sensor"].size(), 16U);
  EXPECT_EQ(json["candidates"][0]["deviation"].size(), 6U);
  EXPECT_TRUE(json["candidates"][0]["distance_m"].is_null());
  EXPECT_EQ(json["candidates"][1]["distance_m"], 12.3);
  EXPECT_EQ(json["candidates"][1]["terms"][0]["cost"], 5.5);
  EXPECT_EQ(json["lost_at"], "verify");
  EXPECT_EQ(json["would_have_changed_it"][0]["value"], "0.41");
}

TEST(StepMeaning, IsTheNameItselfForAStepOfANewerServer) {
  EXPECT_EQ(step_meaning("something_new"), "something_new");
}

}  // namespace
}  // namespace landmarkdb::client
