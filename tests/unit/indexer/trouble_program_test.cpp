// What goes wrong from outside, run through the binary: each a clear sentence and its status, the
// database as before.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "store/sqlite.hpp"
#include "tests/unit/indexer/indexer_fixture.hpp"

namespace landmarkdb::indexer::testing {
namespace {

using ::testing::HasSubstr;

class IndexerTrouble : public IndexerProgram {
 protected:
  // One sentence on standard error and the status; nothing on standard output.
  void expect_refused(const RunResult& result, int status) const {
    EXPECT_EQ(result.status, status) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.err.starts_with("landmarkdb-indexer: ")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  // 64 bytes from the middle of the largest chunk of an array.
  std::string piece_of_largest_chunk() const {
    const sqlite::Database database(db_, sqlite::OpenMode::kReadOnly, std::chrono::milliseconds(0));
    sqlite::Statement row(database,
                          "SELECT substr(data, length(data) / 2, 64) FROM segment_chunk "
                          "ORDER BY length(data) DESC LIMIT 1");
    if (!row.step()) return {};
    const auto blob = row.blob(0);
    return {reinterpret_cast<const char*>(blob.data()), blob.size()};
  }
};

TEST_F(IndexerTrouble, WrongUsageIsStatus2) {
  write("pose.txt", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"frobnicate"},
      {"add", "room"},
      {"add", "room", scan(), "--frobnicate"},
      {"add", "room", scan(), "--kind", "idea"},
      {"add", "room", scan(), "--keypoints", "best"},
      {"add", "room", scan(), "--units", "furlong"},
      {"add", "room", scan(), "--voxel", "0"},
      {"add", "room", scan(), "--voxel", "small"},
      {"add", "room", scan(), "--up", "0,0"},
      {"add", "room", scan(), "--up", "0,0,0"},
      {"add", "room", scan(), "--viewpoint", "1,2"},
      {"add", "room", scan(0), scan(1), "--viewpoint", "1,2,3"},
      {"add", "room", scan(0), scan(1), "--pose", path("pose.txt")},
      {"add", "room", scan(), "--pose", path("pose.txt"), "--pose", path("pose.txt")},
      {"landmark"},
      {"landmark", "add", "room", "x", "--box", "0,0,0,0,0,0"},
      {"rename", "room"},
      {"list", "--threads", "0"}};
  for (const auto& arguments : wrong) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    const RunResult result = run(arguments);
    expect_refused(result, 2);
    EXPECT_THAT(result.err, HasSubstr("--help"));
  }
  expect_refused(run_program("landmarkdb-indexer", {"list"}), 2);  // no --db
}

TEST_F(IndexerTrouble, UnknownNamesAreStatus3) {
  add("room");
  expect_refused(run({"show", "nowhere"}), 3);
  expect_refused(run({"remove", "nowhere"}), 3);
  expect_refused(run({"rename", "nowhere", "x"}), 3);
  expect_refused(run({"rollback", "nowhere"}), 3);
  expect_refused(run({"tag", "nowhere", "a=b"}), 3);
  expect_refused(run({"landmark", "list", "nowhere"}), 3);
  expect_refused(run({"export", "nowhere", path("x")}), 3);
  const auto error = run_json({"show", "nowhere"}, 3).at("error");
  EXPECT_EQ(error.at("code"), "NOT_FOUND");
  EXPECT_THAT(error.at("message").get<std::string>(), HasSubstr("nowhere"));
}

TEST_F(IndexerTrouble, BadCloudsAreStatus7AndMakeNoDatabase) {
  const std::string good = bytes_of(scan());
  write("noise.ply", std::string(5000, '\x07'));
  write("empty.ply", "");
  write("cut.ply", good.substr(0, good.size() / 2));
  write("lying.pcd",
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
        "WIDTH 1000000000000\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1000000000000\n"
        "DATA binary\n1234");
  write("lying.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n1234");
  write("none.xyz", "# no points\n");
  write("nan.xyz", "nan nan nan\nnan nan nan\n");
  write("one.xyz", "1 2 3\n");
  write("three.xyz", "0 0 0\n1 0 0\n0 1 0\n");
  std::string plane;
  std::string line;
  for (int i = 0; i < 60; ++i) {
    line += std::to_string(0.01 * i) + " 0 0\n";
    for (int j = 0; j < 60; ++j) {
      plane += std::to_string(0.05 * i) + ' ' + std::to_string(0.05 * j) + " 1\n";
    }
  }
  write("line.xyz", line);
  write("plane.xyz", plane);
  const std::vector<std::string> before = files();
  for (const char* name : {"missing.ply",
                           "noise.ply",
                           "empty.ply",
                           "cut.ply",
                           "lying.pcd",
                           "lying.ply",
                           "none.xyz",
                           "nan.xyz",
                           "one.xyz",
                           "three.xyz",
                           "line.xyz",
                           "plane.xyz"}) {
    SCOPED_TRACE(name);
    expect_refused(run({"add", "room", path(name), "--quiet"}), 7);
  }
  expect_refused(run({"add", "room", folder_.string(), "--quiet"}), 7);
  EXPECT_EQ(files(), before);
}

TEST_F(IndexerTrouble, BadCloudsLeaveADatabaseAsItWas) {
  add("room");
  const auto before = contents();
  write("cut.ply", bytes_of(scan()).substr(0, 4000));
  expect_refused(run({"add", "room", path("cut.ply"), "--quiet"}), 7);
  expect_refused(run({"add", "room", scan(0), path("cut.ply"), "--quiet"}), 7);
  EXPECT_EQ(contents(), before);
}

TEST_F(IndexerTrouble, BadPoseFilesAreStatus7) {
  write("short.txt", "1 2 3");
  write("sheared.txt", "1 1 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  for (const char* name : {"missing.txt", "short.txt", "sheared.txt"}) {
    SCOPED_TRACE(name);
    const RunResult result = run({"add", "room", scan(), "--pose", path(name)});
    expect_refused(result, 7);
    EXPECT_THAT(result.err, HasSubstr(name));
  }
}

TEST_F(IndexerTrouble, BadNamesAreWrongUsageBeforeAnyWork) {
  for (const char* name : {"", "a/b", "line\nbreak"}) {
    expect_refused(run({"add", name, path("missing.ply"), "--quiet"}), 2);
    expect_refused(run({"rename", "room", name}), 2);
    expect_refused(run({"landmark", "add", "room", name, "--box", "0,0,0,1,1,1"}), 2);
  }
  expect_refused(run({"import", path("missing.scene"), "--as", "a/b", "--quiet"}), 2);
  EXPECT_FALSE(std::filesystem::exists(db_));
}

TEST_F(IndexerTrouble, OneBadTagIsWrongUsageAndNoneIsSet) {
  add("room");
  for (const char* tag : {"a/b=1", "=1", "plain", "a=line\nbreak"}) {
    expect_refused(run({"tag", "room", "good=1", tag}), 2);
  }
  expect_refused(run({"tag", "room", "good=1", "none="}), 3);
  EXPECT_TRUE(run_json({"show", "room"}).at("tags").empty());
}

TEST_F(IndexerTrouble, AFileThatIsNoDatabaseIsStatus7) {
  write("site.db", "this is a text, and not a short one either, for a database has a header");
  const std::string before = bytes_of(db_);
  expect_refused(run({"list"}), 7);
  expect_refused(run({"add", "room", scan(), "--quiet"}), 7);
  EXPECT_EQ(bytes_of(db_), before);
}

TEST_F(IndexerTrouble, AMissingDatabaseIsSaidSoAndNotMade) {
  const RunResult result = run({"list"});
  expect_refused(result, 7);
  EXPECT_THAT(result.err, HasSubstr("site.db"));
  EXPECT_FALSE(std::filesystem::exists(db_));
  expect_refused(run_program("landmarkdb-indexer",
                             {"--db", path("no/such/folder.db"), "add", "room", scan(), "--quiet"}),
                 7);
}

TEST_F(IndexerTrouble, ANewerDatabaseIsStatus6) {
  add("room");
  run({"optimize", "--quiet"});  // everything is in the one file now
  std::fstream file(db_, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(60);  // user_version, big-endian, of SQLite's header
  file.write("\0\0\x03\xe7", 4);
  file.close();
  const std::string before = bytes_of(db_);
  for (const std::vector<std::string>& command : {std::vector<std::string>{"list"},
                                                  {"check"},
                                                  {"migrate"},
                                                  {"add", "b", scan(), "--quiet"}}) {
    SCOPED_TRACE(command.front());
    const RunResult result = run(command);
    expect_refused(result, 6);
    EXPECT_THAT(result.err, HasSubstr("999"));
  }
  EXPECT_EQ(bytes_of(db_), before);
}

TEST_F(IndexerTrouble, ADamagedDatabaseIsStatus5AndSaysWhere) {
  add("room");
  run({"optimize", "--quiet"});
  std::string bytes = bytes_of(db_);
  const std::size_t at = bytes.find(piece_of_largest_chunk());
  ASSERT_NE(at, std::string::npos);
  for (std::size_t i = at; i < at + 64; ++i) bytes[i] ^= '\x55';
  write("site.db", bytes);
  const RunResult result = run({"check", "--quiet"});
  EXPECT_EQ(result.status, 5) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("room"));
  const auto report = run_json({"check"}, 5);
  EXPECT_EQ(report.at("ok"), false);
  EXPECT_FALSE(report.at("findings").empty());
}

TEST_F(IndexerTrouble, SigintWhileIndexingLeavesTheDatabaseAsItWas) {
  if (!testing::has_terminals()) GTEST_SKIP() << "no pseudo-terminals: is /dev/pts mounted?";
  add("room");
  const auto before = contents();
  const std::vector<std::string> files_before = files();
  for (const char* stage : {"keypoints", "describe"}) {
    SCOPED_TRACE(stage);
    const RunResult result =
        run({"add", "room", scan(), "--voxel", "0.02", "--radius", "1", "--threads", "1"},
            {.signal_at = stage, .signal = SIGINT});
    EXPECT_EQ(result.status, 130) << result.err;
    EXPECT_EQ(contents(), before);
    EXPECT_EQ(files(), files_before);
  }
}

TEST_F(IndexerTrouble, SigintOnANewDatabaseLeavesNone) {
  if (!testing::has_terminals()) GTEST_SKIP() << "no pseudo-terminals: is /dev/pts mounted?";
  const std::vector<std::string> files_before = files();
  const RunResult result =
      run({"add", "room", scan(), "--voxel", "0.02", "--radius", "1", "--threads", "1"},
          {.signal_at = "describe", .signal = SIGTERM});
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_EQ(files(), files_before);
}

TEST_F(IndexerTrouble, AFileSizeLimitIsStatus8AndLeavesTheDatabaseAsItWas) {
  constexpr std::uint64_t kTooLittle = 100'000;  // the scene takes some megabytes
  const RunOptions limited{.max_file_bytes = kTooLittle};
  const std::vector<std::string> none = files();
  expect_refused(run({"add", "room", scan(), "--quiet"}, limited), 8);
  EXPECT_EQ(files(), none);

  add("room");
  const auto before = contents();
  expect_refused(run({"add", "room", scan(1), "--quiet"}, limited), 8);
  expect_refused(run({"backup", path("copy.db"), "--quiet"}, limited), 8);
  expect_refused(run({"export", "room", path("room.scene"), "--quiet"}, limited), 8);
  EXPECT_FALSE(std::filesystem::exists(path("copy.db")));
  EXPECT_FALSE(std::filesystem::exists(path("room.scene")));
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(run({"check"}).status, 0);
}

TEST_F(IndexerTrouble, AFullDiskIsStatus8AndLeavesTheDatabaseAsItWas) {
  const std::string disk = path("disk");
  std::filesystem::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=6m") != 0) {
    GTEST_SKIP() << "no right to mount a small disk";
  }
  const std::string db = disk + "/site.db";
  const auto on_disk = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--db", db, "--quiet"});
    return run_program("landmarkdb-indexer", arguments);
  };
  int status = 0;
  std::string before;
  for (int i = 0; i < 20 && status == 0; ++i) {
    before = on_disk({"list", "--json"}).out;
    status = on_disk({"add", "room" + std::to_string(i), scan()}).status;
  }
  EXPECT_EQ(status, 8);
  EXPECT_EQ(on_disk({"list", "--json"}).out, before);
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

TEST_F(IndexerTrouble, AFolderThatMayNotBeWrittenToIsStatus9) {
  std::filesystem::permissions(folder_, std::filesystem::perms(0555));
  const RunOptions unprivileged{.as_nobody = ::geteuid() == 0};
  const RunResult result = run({"add", "room", scan(), "--quiet"}, unprivileged);
  if (result.status == 127) GTEST_SKIP() << "the program cannot be run without privileges here";
  expect_refused(result, 9);
}

TEST_F(IndexerTrouble, ADatabaseThatMayOnlyBeReadIsReadAndNotWritten) {
  add("room");
  const std::string before = bytes_of(db_);
  std::filesystem::permissions(db_, std::filesystem::perms(0444));
  std::filesystem::permissions(folder_, std::filesystem::perms(0555));
  const RunOptions unprivileged{.as_nobody = ::geteuid() == 0};
  const RunResult list = run({"list"}, unprivileged);
  if (list.status == 127) GTEST_SKIP() << "the program cannot be run without privileges here";
  EXPECT_EQ(list.status, 0) << list.err;
  expect_refused(run({"remove", "room"}, unprivileged), 9);
  expect_refused(run({"add", "b", scan(), "--quiet"}, unprivileged), 9);
  EXPECT_EQ(bytes_of(db_), before);
}

TEST_F(IndexerTrouble, OutputThatCannotBeWrittenIsNotSilent) {
  add("room");
  const char* folder = std::getenv("LANDMARKDB_BIN");
  const std::string command = std::string(folder) + "/landmarkdb-indexer --db '" + db_ +
                              "' list > /dev/full 2> '" + path("err.txt") + "'";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 8);
  EXPECT_THAT(bytes_of(path("err.txt")), HasSubstr("standard output"));
}

}  // namespace
}  // namespace landmarkdb::indexer::testing
