// The indexer's everyday commands, run through its binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/indexer/indexer_fixture.hpp"

namespace landmarkdb::indexer::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST_F(IndexerProgram, AddsAScanAndListsIt) {
  const auto added = run_json({"add", "room", scan()});
  EXPECT_EQ(added.at("scene"), "room");
  EXPECT_EQ(added.at("version"), 1);
  EXPECT_GT(added.at("points_used").get<int>(), 100);
  EXPECT_GT(added.at("keypoints").get<int>(), 10);
  EXPECT_GT(added.at("options").at("voxel_m").get<double>(), 0.0);

  const auto scenes = run_json({"list"}).at("scenes");
  ASSERT_EQ(scenes.size(), 1U);
  EXPECT_EQ(scenes[0].at("name"), "room");
  EXPECT_EQ(scenes[0].at("kind"), "place");
  EXPECT_EQ(scenes[0].at("state"), "active");
  EXPECT_EQ(scenes[0].at("keypoints"), added.at("keypoints"));
  EXPECT_THAT(scenes[0].at("sources"), ElementsAre("scan0.ply"));
}

TEST_F(IndexerProgram, KeepsStandardOutputForData) {
  const RunResult result = run({"add", "room", scan()});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("added room version 1"));
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 1);
  EXPECT_EQ(run({"add", "room", scan(), "--quiet"}).err, "");
}

TEST_F(IndexerProgram, TakesSeveralCloudsWithPosesAndViewpoints) {
  write("pose.txt", kIdentity);
  const auto added = run_json({"add",
                               "room",
                               scan(0),
                               scan(1),
                               "--pose",
                               path("pose.txt"),
                               "--pose",
                               path("pose.txt"),
                               "--viewpoint",
                               "1,1,1.5",
                               "--viewpoint",
                               "3,2,1.5"});
  EXPECT_EQ(added.at("points").get<int>(), 24'000);
  EXPECT_THAT(added.at("sources"), ElementsAre("scan0.ply", "scan1.ply"));
}

TEST_F(IndexerProgram, GivesANameThatExistsANewVersionAndRollsBack) {
  add("room");
  EXPECT_EQ(run_json({"add", "room", scan(1)}).at("version"), 2);
  EXPECT_EQ(run_json({"show", "room"}).at("version"), 2);
  EXPECT_EQ(run_json({"show", "room"}).at("versions").size(), 2U);
  EXPECT_EQ(run_json({"rollback", "room"}).at("version"), 1);
  EXPECT_EQ(run_json({"show", "room"}).at("version"), 1);
  EXPECT_EQ(run({"rollback", "room"}).status, 2);  // nothing before the first
}

TEST_F(IndexerProgram, RenamesAndRemoves) {
  add("room");
  EXPECT_EQ(run_json({"rename", "room", "hall"}).at("scene"), "hall");
  EXPECT_EQ(run({"show", "room"}).status, 3);
  EXPECT_EQ(run_json({"remove", "hall"}).at("removed"), "hall");
  EXPECT_TRUE(contents().at("scenes").empty());
  EXPECT_EQ(run({"list"}).out, "no scenes\n");
}

TEST_F(IndexerProgram, TakesACommandsNameForAScenesName) {
  add("list");
  EXPECT_EQ(run_json({"show", "list"}).at("name"), "list");
}

TEST_F(IndexerProgram, SetsAndTakesAwayTags) {
  add("room");
  const auto tags = run_json({"tag", "room", "floor=2", "formula=a=b"}).at("tags");
  EXPECT_EQ(tags, nlohmann::json({{"floor", "2"}, {"formula", "a=b"}}));
  EXPECT_EQ(run_json({"tag", "room", "floor="}).at("tags").size(), 1U);
  EXPECT_EQ(run({"tag", "room", "floor"}).status, 2);
}

TEST_F(IndexerProgram, KeepsLandmarks) {
  add("room");
  run_json({"landmark", "add", "room", "vents", "--box", "0,-1,2,4.5,1,3"});
  const auto landmarks = run_json({"landmark", "list", "room"}).at("landmarks");
  ASSERT_EQ(landmarks.size(), 1U);
  EXPECT_EQ(landmarks[0].at("name"), "vents");
  EXPECT_THAT(landmarks[0].at("min_m"), ElementsAre(0.0, -1.0, 2.0));
  EXPECT_THAT(run({"landmark", "list", "room"}).out, HasSubstr("0, -1, 2"));
  EXPECT_EQ(run({"landmark", "remove", "room", "vents"}).status, 0);
  EXPECT_EQ(run({"landmark", "remove", "room", "vents"}).status, 3);
}

TEST_F(IndexerProgram, ShowsTablesToPeople) {
  add("room");
  const RunResult list = run({"list"});
  EXPECT_TRUE(list.out.starts_with("NAME  KIND   VERSION")) << list.out;
  const RunResult show = run({"show", "room"});
  EXPECT_THAT(show.out, HasSubstr("descriptor radius"));
  EXPECT_THAT(show.out, HasSubstr("VERSION"));
}

TEST_F(IndexerProgram, EstimatesWithoutTouchingADatabase) {
  const std::vector<std::string> before = files();
  const auto estimate = run_json({"add", "room", scan(), "--estimate"});
  for (const char* key : {"points", "keypoints", "database_bytes", "served_bytes", "seconds"}) {
    EXPECT_GT(estimate.at(key).get<double>(), 0.0) << key;
  }
  EXPECT_GT(estimate.at("options").at("voxel_m").get<double>(), 0.0);
  EXPECT_EQ(files(), before);
  EXPECT_EQ(run_program("landmarkdb-indexer", {"add", "room", scan(), "--estimate"}).status, 0);
}

TEST_F(IndexerProgram, WarnsOfSuspectUnitsAndNamesTheFactor) {
  const RunResult result = run({"add", "room", scan(), "--units", "m"});
  EXPECT_EQ(result.err.find("units_suspect"), std::string::npos);
  PointCloud in_millimetres =
      landmarkdb::testing::make_scene({.stations = 1, .rays = 12'000}).cloud;
  for (Eigen::Vector3f& point : in_millimetres.points) point *= 1000.0F;
  in_millimetres.viewpoints.clear();
  in_millimetres.viewpoint_index.clear();
  write_cloud(path("mm.ply"), in_millimetres);
  const RunResult warned = run({"add", "large", path("mm.ply")});
  EXPECT_EQ(warned.status, 0) << warned.err;
  EXPECT_THAT(warned.err, AllOf(HasSubstr("units_suspect"), HasSubstr("--units mm")));
  EXPECT_EQ(run_json({"add", "large", path("mm.ply")}).at("units_guess"), "mm");
  EXPECT_TRUE(
      run_json({"add", "small", path("mm.ply"), "--units", "mm"}).at("units_guess").is_null());
}

TEST_F(IndexerProgram, ExportsAndImportsAScene) {
  add("room");
  run_json({"tag", "room", "floor=2"});
  EXPECT_EQ(run({"export", "room", path("room.scene")}).status, 0);
  EXPECT_EQ(run({"export", "room", path("room.scene")}).status, 2);  // does not overwrite
  const auto exported = run_json({"show", "room"});
  const auto into_new = [&](const std::vector<std::string>& arguments) {
    return run_program("landmarkdb-indexer", arguments);
  };
  EXPECT_EQ(into_new({"--db", path("other.db"), "import", path("room.scene")}).status, 0);
  EXPECT_EQ(
      into_new({"--db", path("other.db"), "import", path("room.scene"), "--as", "copy"}).status, 0);
  const auto shown =
      nlohmann::json::parse(into_new({"--db", path("other.db"), "show", "copy", "--json"}).out);
  EXPECT_EQ(shown.at("keypoints"), exported.at("keypoints"));
  EXPECT_EQ(shown.at("tags"), exported.at("tags"));
}

TEST_F(IndexerProgram, BacksUpChecksRepairsAndOptimises) {
  add("room");
  EXPECT_EQ(run({"backup", path("copy.db")}).status, 0);
  EXPECT_EQ(run({"backup", path("copy.db")}).status, 2);
  const auto check = run_json({"check"});
  EXPECT_EQ(check.at("ok"), true);
  EXPECT_EQ(check.at("versions"), 1);
  EXPECT_EQ(run_json({"repair"}).at("ok"), true);
  EXPECT_GT(run_json({"optimize"}).at("bytes_after").get<int>(), 0);
  EXPECT_EQ(run_json({"migrate", "--dry-run"}).at("steps").size(), 0U);
  const auto copy = run_program("landmarkdb-indexer", {"--db", path("copy.db"), "list", "--json"});
  EXPECT_EQ(nlohmann::json::parse(copy.out).at("scenes").size(), 1U);
}

TEST_F(IndexerProgram, HelpsOnItselfAndEverySubcommand) {
  const std::vector<std::vector<std::string>> commands = {{},
                                                          {"add"},
                                                          {"remove"},
                                                          {"rename"},
                                                          {"list"},
                                                          {"show"},
                                                          {"rollback"},
                                                          {"tag"},
                                                          {"landmark"},
                                                          {"landmark", "add"},
                                                          {"landmark", "remove"},
                                                          {"landmark", "list"},
                                                          {"check"},
                                                          {"repair"},
                                                          {"migrate"},
                                                          {"optimize"},
                                                          {"backup"},
                                                          {"export"},
                                                          {"import"},
                                                          {"completion"}};
  for (std::vector<std::string> command : commands) {
    command.emplace_back("--help");
    const RunResult help = run_program("landmarkdb-indexer", command);
    EXPECT_EQ(help.status, 0) << command.front();
    EXPECT_THAT(help.out, HasSubstr("Examples:")) << command.front();
    command.back() = "--version";
    const RunResult version = run_program("landmarkdb-indexer", command);
    EXPECT_EQ(version.status, 0) << command.front();
    EXPECT_TRUE(version.out.starts_with("landmarkdb-indexer ")) << version.out;
  }
}

TEST_F(IndexerProgram, PrintsItsManPageAndCompletions) {
  EXPECT_THAT(run_program("landmarkdb-indexer", {"man"}).out, HasSubstr("\\-\\-viewpoint"));
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const RunResult result = run_program("landmarkdb-indexer", {"completion", shell});
    EXPECT_EQ(result.status, 0);
    EXPECT_THAT(result.out, HasSubstr("viewpoint"));
  }
}

}  // namespace
}  // namespace landmarkdb::indexer::testing
