#include "engine/retrieval/list_correspondences.hpp"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>

#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using ::testing::Contains;
using testing::describe_room;
using testing::Frame;
using testing::frame_in;
using testing::localizer_of;
using ::testing::Not;
using testing::small_room;
using testing::SyntheticScene;

struct Lobby {
  SyntheticScene scene = small_room(2);
  std::unique_ptr<Localizer> localizer = localizer_of({describe_room("lobby", scene)});
};

const Lobby& lobby() {
  static const Lobby made;
  return made;
}

std::map<std::string, std::uint64_t> tally(const QueryResult& answer) {
  std::map<std::string, std::uint64_t> counts;
  for (const CorrespondenceRecord& pair : answer.correspondences) ++counts[pair.dropped_by];
  return counts;
}

TEST(ListCorrespondences, HoldsEveryPairOfTheRobustSearchAndItsInliers) {
  QueryOptions options;
  options.want_correspondences = true;
  const QueryResult answer =
      lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
  const CorrespondenceCounts& counts = answer.hypotheses.at(0).counts;
  EXPECT_EQ(answer.correspondences.size(), counts.putative);
  EXPECT_EQ(tally(answer)[""], counts.inliers);
  EXPECT_EQ(tally(answer)["pose"], counts.putative - counts.inliers);
  EXPECT_THAT(answer.warnings, Not(Contains("correspondences_cut")));
}

TEST(ListCorrespondences, NamesGravityWhereItRefusedAProposal) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options;
  options.want_correspondences = true;
  options.explain = true;
  options.up = frame.up_sensor;
  const QueryResult answer = lobby().localizer->query(frame.cloud, options, {});
  std::map<std::string, std::uint64_t> counts = tally(answer);
  EXPECT_GT(counts["up"], 0U);
  EXPECT_EQ(counts[""], answer.hypotheses.at(0).counts.inliers);
  const std::vector<FunnelStep>& funnel = answer.explanation->funnel;
  const auto proposals = std::find_if(funnel.begin(), funnel.end(), [](const FunnelStep& step) {
    return step.name == "proposals";
  });
  ASSERT_NE(proposals, funnel.end());
  // Inliers are named as such even where their frames were refused.
  EXPECT_LE(answer.correspondences.size() - proposals->count - counts[""], counts["up"]);
}

TEST(ListCorrespondences, HoldsEveryPairOfThePapersSearchWithItsFilter) {
  QueryOptions options;
  options.profile = Profile::kPaper;
  options.want_correspondences = true;
  options.keypoints = KeypointMethod::kStructure;
  options.filters = {Filter::kRatio, Filter::kSlope, Filter::kClique};
  options.explain = true;
  options.ratio = 0.9;
  const QueryResult answer =
      lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
  std::map<std::string, std::uint64_t> left;
  for (const FunnelStep& step : answer.explanation->funnel) left[step.name] = step.count;
  std::map<std::string, std::uint64_t> counts = tally(answer);
  EXPECT_EQ(answer.correspondences.size(), left["putative"]);
  EXPECT_EQ(counts["ratio"], left["putative"] - left["ratio"]);
  EXPECT_EQ(counts["slope"], left["ratio"] - left["slope"]);
  EXPECT_EQ(counts["clique"], left["slope"] - left["clique"]);
}

TEST(ListCorrespondences, IsThereWhenTheFiltersLeftNothing) {
  QueryOptions options;
  options.profile = Profile::kPaper;
  options.want_correspondences = true;
  options.explain = true;
  options.keypoints = KeypointMethod::kStructure;
  options.ratio = 0.01;
  const QueryResult answer =
      lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
  ASSERT_EQ(answer.status, QueryStatus::kNotFound);
  EXPECT_GT(answer.correspondences.size(), 0U);
  EXPECT_EQ(tally(answer)["ratio"], answer.correspondences.size());
  // And the explanation names the ratio that would have left four.
  const std::vector<Remedy>& remedies = answer.explanation->remedies;
  ASSERT_EQ(remedies.size(), 1U);
  EXPECT_EQ(remedies[0].option, "--ratio");
  options.ratio = std::stod(remedies[0].value);
  const QueryResult wider = lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
  for (const FunnelStep& step : wider.explanation->funnel) {
    if (step.name != "ratio") continue;
    EXPECT_GE(step.count, 4U);
  }
}

TEST(ListCorrespondences, LeavesTheFarNeighboursOutWhenTheListIsTooLong) {
  // A name as long as a name may be makes the list of a small room too long.
  const SyntheticScene scene = small_room(2);
  SceneRecord record = describe_room(std::string(2000, 'x'), scene);
  const std::unique_ptr<Localizer> localizer = localizer_of({record});
  QueryOptions options;
  options.want_correspondences = true;
  const QueryResult answer = localizer->query(frame_in(scene, 1).cloud, options, {});
  const CorrespondenceCounts& counts = answer.hypotheses.at(0).counts;
  EXPECT_THAT(answer.warnings, Contains("correspondences_cut"));
  EXPECT_LT(answer.correspondences.size(), counts.putative);
  EXPECT_EQ(tally(answer)[""], counts.inliers);
}

}  // namespace
}  // namespace landmarkdb
