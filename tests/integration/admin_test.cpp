#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/cloud/write_cloud.hpp"
#include "tests/integration/site.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::vector<std::string> names(const json& list) {
  std::vector<std::string> out;
  for (const json& scene : list["scenes"]) out.push_back(scene["name"]);
  return out;
}

TEST(Scenes, AreAddedShownTaggedRenamedRolledBackAndRemovedOverTheSocket) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "first", make_small_room(1)).status, 0);
  ServerProcess server(db);

  const std::string cloud = folder / "second.pcd";
  write_cloud(cloud, make_small_room(2).scans.front());
  const Outcome added = server.client({"--json", "scene", "add", "second", cloud, "--up", "0,0,1"});
  ASSERT_EQ(added.status, 0) << added.out << added.err;
  EXPECT_EQ(added.json()["name"], "second");
  EXPECT_EQ(added.json()["version"], 1);
  EXPECT_EQ(added.json()["sources"], json({"second.pcd"}));
  EXPECT_THAT(names(server.client({"--json", "scene", "list"}).json()),
              ::testing::UnorderedElementsAre("first", "second"));

  EXPECT_EQ(server.client({"--json", "scene", "add", "second", cloud}).json()["version"], 2);
  EXPECT_EQ(server.client({"--json", "scene", "rollback", "second"}).json()["version"], 1);
  EXPECT_EQ(server.client({"--json", "scene", "tag", "second", "floor=2"}).json()["tags"]["floor"],
            "2");
  EXPECT_EQ(
      server
          .client({"--json", "scene", "landmark", "add", "second", "desk", "--box", "0,0,0,1,1,1"})
          .json()["landmarks"][0]["name"],
      "desk");
  EXPECT_EQ(server.client({"scene", "rename", "second", "third"}).status, 0);
  const json shown = server.client({"--json", "scene", "show", "third"}).json();
  EXPECT_EQ(shown["versions"].size(), 2U);
  EXPECT_EQ(shown["landmarks"].size(), 1U);
  EXPECT_EQ(server.client({"scene", "remove", "third"}).status, 0);
  EXPECT_EQ(server.client({"scene", "show", "third"}).status, 3);
  EXPECT_EQ(run("landmarkdb-indexer", {"--db", db, "check"}).status, 0);
}

TEST(Scenes, AddedByTheIndexerAreServedAfterReload) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "first", make_small_room(1)).status, 0);
  ServerProcess server(db);
  ASSERT_EQ(index_scene(folder, db, "late", make_small_room(2)).status, 0);
  const Outcome reloaded = server.client({"--json", "reload"});
  EXPECT_EQ(reloaded.status, 0) << reloaded.err;
  EXPECT_EQ(reloaded.json()["scenes"], 2);
  EXPECT_THAT(names(server.client({"--json", "scene", "list"}).json()),
              ::testing::UnorderedElementsAre("first", "late"));
}

TEST(Scenes, StayAsTheyAreOnAReadOnlyServer) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "first", make_small_room(1)).status, 0);
  ServerProcess server(db, {"--read-only"});
  const Outcome refused = server.client({"scene", "remove", "first"});
  EXPECT_EQ(refused.status, 9) << refused.err;
  EXPECT_EQ(server.client({"scene", "show", "first"}).status, 0);
}

TEST(Server, TellsHealthAndFigures) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "first", make_small_room(1)).status, 0);
  ServerProcess server(db);
  EXPECT_EQ(server.client({"--json", "health"}).json()["ready"], true);
  const json stats = server.client({"--json", "stats"}).json();
  EXPECT_EQ(stats["scenes"], 1);
  EXPECT_GT(stats["points"].get<int>(), 0);
  EXPECT_THAT(server.client({"stats"}).out, HasSubstr("1 scene"));
}

TEST(Server, AsksForTheTokenItWasGiven) {
  const TempFolder folder;
  const std::string db = folder / "small.db";
  ASSERT_EQ(index_scene(folder, db, "first", make_small_room(1)).status, 0);
  const std::string token = folder / "token";
  const std::string wrong = folder / "wrong";
  std::ofstream(token) << "correct-horse-battery-staple\n";
  std::ofstream(wrong) << "incorrect-horse-battery-staple\n";
  ServerProcess server(db, {"--token-file", token});
  EXPECT_EQ(server.client({"scene", "list"}).status, 9);
  EXPECT_EQ(server.client({"--token-file", wrong, "scene", "list"}).status, 9);
  EXPECT_EQ(server.client({"--token-file", token, "scene", "list"}).status, 0);
}

}  // namespace
}  // namespace landmarkdb::testing
