#include "engine/retrieval/explain.hpp"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>

#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using testing::describe_room;
using testing::Frame;
using testing::frame_in;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::localizer_of;
using testing::small_room;
using testing::SyntheticScene;

struct Lobby {
  SyntheticScene scene = small_room(2);
  SceneRecord record = describe_room("lobby", scene);
  std::unique_ptr<Localizer> alone = localizer_of({record});
  std::unique_ptr<Localizer> twice = [this] {
    SceneRecord copy = record;
    copy.name = "copy";
    return localizer_of({record, copy});
  }();
};

const Lobby& lobby() {
  static const Lobby made;
  return made;
}

QueryOptions explained() {
  QueryOptions options;
  options.explain = true;
  return options;
}

const Remedy* remedy_for(const Explanation& explanation, const std::string& option) {
  const auto found = std::find_if(explanation.remedies.begin(),
                                  explanation.remedies.end(),
                                  [&](const Remedy& r) { return r.option == option; });
  return found == explanation.remedies.end() ? nullptr : &*found;
}

TEST(Explain, IsLeftOutUnlessAskedFor) {
  const QueryResult answer = lobby().alone->query(frame_in(lobby().scene, 1).cloud, {}, {});
  EXPECT_FALSE(answer.explanation);
}

TEST(Explain, CountsWhatEachStepLeft) {
  const Frame frame = frame_in(lobby().scene, 1);
  const QueryResult answer = lobby().alone->query(frame.cloud, explained(), {});
  ASSERT_TRUE(answer.explanation);
  std::map<std::string, std::uint64_t> left;
  for (const FunnelStep& step : answer.explanation->funnel) left[step.name] = step.count;
  EXPECT_EQ(left["points"], answer.query.points);
  EXPECT_EQ(left["used"], answer.query.points_used);
  EXPECT_EQ(left["keypoints"], answer.query.keypoints);
  EXPECT_EQ(left["putative"], answer.hypotheses.at(0).counts.putative);
  EXPECT_GE(left["proposals"], 1U);  // pairs propose poses, and planes do
  EXPECT_GE(left["proposals"], left["survivors"]);
  EXPECT_GE(left["survivors"], left["refined"]);
  EXPECT_GE(left["refined"], left["verified"]);
  EXPECT_GE(left["verified"], left["places"]);
  EXPECT_GE(left["places"], left["confident"]);
  EXPECT_GE(left["confident"], 1U);
  EXPECT_EQ(left.count("ratio"), 0U);
  EXPECT_EQ(left.count("expected"), 0U);
}

TEST(Explain, AgreesWithTheAnswerItExplains) {
  const Frame frame = frame_in(lobby().scene, 1);
  const QueryResult answer = lobby().alone->query(frame.cloud, explained(), {});
  ASSERT_EQ(answer.status, QueryStatus::kLocalized);
  const Explanation& why = *answer.explanation;
  EXPECT_EQ(why.lost_at, "");
  EXPECT_THAT(why.remedies, IsEmpty());
  ASSERT_FALSE(why.candidates.empty());
  EXPECT_LE(why.candidates.size(), kMostExplainedCandidates);
  EXPECT_EQ(why.candidates[0].role, CandidateRole::kBest);
  EXPECT_EQ(why.candidates[0].confidence, answer.hypotheses[0].confidence);
  EXPECT_EQ(why.candidates[0].T_scene_sensor, answer.hypotheses[0].T_scene_sensor);
  EXPECT_FALSE(why.candidates[0].distance_m);
  for (std::size_t i = 1; i < why.candidates.size(); ++i) {
    EXPECT_EQ(why.candidates[i].role, CandidateRole::kBehind);
    EXPECT_LE(why.candidates[i].quality, why.candidates[i - 1].quality);
    EXPECT_TRUE(why.candidates[i].distance_m);
  }
}

TEST(Explain, ItsMinConfidenceReallyWouldHaveAcceptedTheAnswer) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options = explained();
  options.min_confidence = 1.0;  // no answer is that sure
  const QueryResult declined = lobby().alone->query(frame.cloud, options, {});
  ASSERT_EQ(declined.status, QueryStatus::kNotFound);
  EXPECT_EQ(declined.explanation->lost_at, "verify");
  EXPECT_THAT(declined.explanation->why, HasSubstr("wanted 1.00"));
  const Remedy* remedy = remedy_for(*declined.explanation, "--min-confidence");
  ASSERT_NE(remedy, nullptr);
  EXPECT_EQ(remedy->effect, "localized");
  options.min_confidence = std::stod(remedy->value);
  EXPECT_EQ(lobby().alone->query(frame.cloud, options, {}).status, QueryStatus::kLocalized);
}

TEST(Explain, ItsSceneReallyWouldHaveToldTwoCopiesApart) {
  const Frame frame = frame_in(lobby().scene, 1);
  const QueryResult answer = lobby().twice->query(frame.cloud, explained(), {});
  ASSERT_EQ(answer.status, QueryStatus::kAmbiguous);
  const Explanation& why = *answer.explanation;
  EXPECT_EQ(why.lost_at, "verify");
  EXPECT_EQ(why.candidates.at(1).role, CandidateRole::kRival);
  EXPECT_THAT(why.candidates[0].terms.at(0).name, ::testing::AnyOf("margin", "contrast"));
  EXPECT_EQ(why.scenes.size(), 2U);
  const Remedy* remedy = remedy_for(why, "--scene");
  ASSERT_NE(remedy, nullptr);
  QueryOptions options;
  options.scenes = {remedy->value};
  EXPECT_EQ(lobby().twice->query(frame.cloud, options, {}).status, QueryStatus::kLocalized);
}

TEST(Explain, SaysThatAWrongUpDirectionLostTheQuery) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options = explained();
  options.profile = Profile::kPaper;  // searches without gravity, and is checked against it
  options.keypoints = KeypointMethod::kStructure;
  options.up = -frame.up_sensor;
  const QueryResult answer = lobby().alone->query(frame.cloud, options, {});
  EXPECT_EQ(answer.status, QueryStatus::kNotFound);
  ASSERT_TRUE(answer.explanation);
  for (const Remedy& remedy : answer.explanation->remedies) {
    options.up.reset();
    if (remedy.option != "without --up") continue;
    EXPECT_NE(lobby().alone->query(frame.cloud, options, {}).status, QueryStatus::kNotFound);
  }
}

TEST(Explain, SaysThatACloudOfThreePointsNeverCameToBeSearchedFor) {
  PointCloud cloud;
  cloud.points = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const QueryResult answer = lobby().alone->query(cloud, explained(), {});
  ASSERT_TRUE(answer.explanation);
  EXPECT_EQ(answer.explanation->lost_at, "preprocess");
  EXPECT_EQ(answer.explanation->funnel.size(), 2U);
}

TEST(Explain, SaysWhichVoxelAThinCloudWouldHaveNeeded) {
  Frame frame = frame_in(lobby().scene, 1);
  PointCloud thin = frame.cloud;
  thin.points.clear();
  thin.width = thin.height = 0;
  for (std::size_t i = 0; i < frame.cloud.size(); i += 600)
    thin.points.push_back(frame.cloud.points[i]);
  const QueryResult answer = lobby().alone->query(thin, explained(), {});
  ASSERT_THAT(answer.reason, HasSubstr("too far for every entry"));
  EXPECT_EQ(answer.explanation->lost_at, "keypoints");
  const Remedy* remedy = remedy_for(*answer.explanation, "landmarkdb-indexer add --voxel");
  ASSERT_NE(remedy, nullptr);
  EXPECT_GT(std::stod(remedy->value), lobby().record.options.voxel_m);
}

TEST(ConfidenceTerms, CostNothingWhereAFigureIsIdeal) {
  Evidence evidence;
  evidence.overlap = evidence.explained = evidence.coverage = evidence.observability = 1.0;
  evidence.agreeing = 200.0;
  for (const ConfidenceTerm& term : confidence_terms(evidence, 1.0, 1.0)) {
    EXPECT_EQ(term.cost, 0.0) << term.name;
  }
}

TEST(ConfidenceTerms, PutTheCostliestFirst) {
  Evidence evidence;
  evidence.overlap = evidence.explained = evidence.coverage = evidence.observability = 1.0;
  evidence.agreeing = 200.0;
  EXPECT_EQ(confidence_terms(evidence, 1.0, 0.0).at(0).name, "margin");
  evidence.contradicted = 0.5;
  EXPECT_EQ(confidence_terms(evidence, 1.0, 1.0).at(0).name, "contradicted");
}

}  // namespace
}  // namespace landmarkdb
