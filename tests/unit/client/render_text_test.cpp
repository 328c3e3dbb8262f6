#include "client/render_text.hpp"

#include <gmock/gmock.h>

namespace landmarkdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Hypothesis in_scene(const std::string& name, double x_m) {
  Hypothesis h;
  h.scene = name;
  h.confidence = 0.875;
  h.T_scene_sensor(0, 3) = x_m;
  return h;
}

TEST(QueryText, SaysWhereInAFewLines) {
  QueryResult result;
  result.status = QueryStatus::kLocalized;
  result.hypotheses = {in_scene("lobby", 1.25), in_scene("attic", 9.5)};
  result.hypotheses[0].landmark = "desk";
  const std::string text = query_text(result);
  EXPECT_THAT(text, StartsWith("localized: scene lobby, landmark desk, confidence 0.8"));
  EXPECT_THAT(text, AllOf(HasSubstr("x 1.250"), HasSubstr("yaw 0.00 deg"), HasSubstr("chain")));
  EXPECT_THAT(text, HasSubstr("2. scene attic"));
  EXPECT_EQ(text.back(), '\n');
}

TEST(QueryText, ListsEveryPoseWhenAmbiguous) {
  QueryResult result;
  result.status = QueryStatus::kAmbiguous;
  result.hypotheses = {
      in_scene("floor-1", 1.0), in_scene("floor-2", 2.0), in_scene("floor-3", 3.0)};
  result.hypotheses[1].rival = true;
  const std::string text = query_text(result);
  EXPECT_THAT(text, StartsWith("ambiguous: 2 poses")) << "the third is none of them";
  EXPECT_THAT(text, HasSubstr("floor-2, confidence 0.88, a rival of the first"));
  EXPECT_THAT(text,
              AllOf(HasSubstr("1. scene floor-1"),
                    HasSubstr("x 1.000"),
                    HasSubstr("2. scene floor-2"),
                    HasSubstr("x 2.000")));
}

TEST(QueryText, CountsNoRivalsWhereNoneIsListed) {
  QueryResult result;
  result.status = QueryStatus::kAmbiguous;
  result.hypotheses = {in_scene("floor-1", 1.0)};  // --top 1, or a pose that slides
  EXPECT_THAT(query_text(result), StartsWith("ambiguous: the pose cannot be told from others"));
}

TEST(QueryText, GivesReasonAndHintWhenNothingWasFound) {
  QueryResult result;
  result.reason = "verify: no pose overlaps";
  EXPECT_THAT(query_text(result),
              AllOf(StartsWith("not_found: verify: no pose overlaps\n"), HasSubstr("hint")));
}

TEST(QueryText, ExplainsWarningsItKnowsAndPrintsTheOthers) {
  QueryResult result;
  result.warnings = {"units_suspect", "something_new"};
  EXPECT_THAT(
      query_text(result),
      AllOf(HasSubstr("units_suspect: "), HasSubstr("--units"), HasSubstr("something_new\n")));
}

TEST(QueryText, LetsNoNameSteerTheTerminal) {
  QueryResult result;
  result.status = QueryStatus::kLocalized;
  result.hypotheses = {in_scene("a\033[2J", 0.0)};
  result.warnings = {"odd\033[2J"};
  EXPECT_THAT(query_text(result), Not(HasSubstr("\033")));
}

}  // namespace
}  // namespace landmarkdb::client
