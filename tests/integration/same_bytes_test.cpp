// The same question has the same answer, to the last bit, whatever computes it.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/cloud/write_cloud.hpp"
#include "server/convert_query.hpp"
#include "tests/integration/site.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;

// All that an answer says, the times apart, as it goes over the wire.
std::string bytes_of(const QueryResult& answer) {
  v1::QueryResult message = to_proto(answer);
  message.clear_timing();
  return message.SerializeAsString();
}

RunContext on(int threads) {
  RunContext context;
  context.threads = threads;
  return context;
}

// Asks for everything there is to an answer.
QueryOptions everything(Profile profile) {
  QueryOptions options;
  options.profile = profile;
  options.top = 10;
  options.want_correspondences = true;
  options.explain = true;
  options.want_scene_points = 2'000;
  return options;
}

class SameBytes : public ::testing::TestWithParam<Profile> {};

TEST_P(SameBytes, ForOneTwoAndFiveThreads) {
  const SyntheticScene room = small_room(2);
  const SyntheticScene elsewhere = small_room(3);
  const SceneRecord lobby = describe_room("lobby", room);
  SceneRecord copy = lobby;
  copy.name = "copy";
  const auto one = localizer_of({lobby});
  const auto both = localizer_of({lobby, copy});
  const struct {
    const char* what;
    const Localizer& where;
    PointCloud cloud;
  } questions[] = {
      {"localized", *one, frame_in(room, 1).cloud},
      {"ambiguous", *both, frame_in(room, 1).cloud},
      {"absent", *one, frame_in(elsewhere, 1).cloud},
  };
  const QueryOptions options = everything(GetParam());
  for (const auto& question : questions) {
    SCOPED_TRACE(question.what);
    const std::string first = bytes_of(question.where.query(question.cloud, options, on(1)));
    EXPECT_GT(first.size(), 1'000U);
    for (const int threads : {1, 2, 5}) {
      // Not EXPECT_EQ: nobody reads a megabyte of bytes.
      const QueryResult again = question.where.query(question.cloud, options, on(threads));
      EXPECT_TRUE(bytes_of(again) == first) << threads << " threads";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles,
                         SameBytes,
                         ::testing::Values(Profile::kRobust, Profile::kPaper),
                         [](const auto& profile) {
                           return profile.param == Profile::kPaper ? "Paper" : "Robust";
                         });

// The client's answers of one server that was just started, as text, the times apart.
std::vector<std::string> answers_of(const std::string& db,
                                    const std::vector<std::string>& clouds,
                                    const std::vector<std::string>& server_arguments) {
  const ServerProcess server(db, server_arguments);
  std::vector<std::string> answers;
  for (const std::string& cloud : clouds) {
    for (const char* profile : {"robust", "paper"}) {
      const Outcome outcome =
          server.client({"--json", "query", cloud, "--profile", profile, "--explain"});
      json answer = outcome.json();
      EXPECT_TRUE(answer.contains("status")) << outcome.out << outcome.err;
      EXPECT_EQ(answer.erase("timing_ms"), 1U);
      answers.push_back(std::to_string(outcome.status) + " " + answer.dump());
    }
  }
  return answers;
}

TEST(SameAnswer, ComesFromEveryServerAndFromEveryIndexingOfTheSamePlace) {
  const TempFolder folder;
  const SyntheticScene room = small_room(2);
  std::vector<std::string> clouds;
  for (const std::uint64_t seed : {1, 2}) {
    clouds.push_back(folder / ("view" + std::to_string(seed) + ".ply"));
    write_cloud(clouds.back(), frame_in(room, seed).cloud);
  }
  for (const char* db : {"a.db", "b.db"}) {
    const Outcome indexed = index_scene(folder, folder / db, "room", room);
    ASSERT_EQ(indexed.status, 0) << indexed.out << indexed.err;
  }
  const std::vector<std::string> first = answers_of(folder / "a.db", clouds, {"--threads", "1"});
  EXPECT_THAT(first[0], ::testing::StartsWith("0 "));  // there is a pose to agree on
  EXPECT_EQ(answers_of(folder / "a.db", clouds, {"--threads", "1"}), first);
  EXPECT_EQ(answers_of(folder / "a.db", clouds, {"--threads", "2"}), first);
  EXPECT_EQ(answers_of(folder / "b.db", clouds, {"--threads", "5"}), first);
}

}  // namespace
}  // namespace landmarkdb::testing
