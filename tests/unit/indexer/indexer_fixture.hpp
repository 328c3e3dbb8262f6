#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/cloud/write_cloud.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/unit/indexer/run_program.hpp"

namespace landmarkdb::indexer::testing {

// A folder of its own for each test, with a small room scanned from two stations. The program is
// run through its binary, as a user does.
class IndexerProgram : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const SyntheticRoom room;
    shared_room() = room.clouds;
  }

  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("landmarkdb_indexer_" + std::to_string(::getpid()) + '_' + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    db_ = path("site.db");
    for (std::size_t i = 0; i < shared_room().size(); ++i) {
      write_cloud(path("scan" + std::to_string(i) + ".ply"), shared_room()[i]);
    }
  }
  void TearDown() override {
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
    std::filesystem::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string scan(int station = 0) const {
    return path("scan" + std::to_string(station) + ".ply");
  }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }
  static std::string bytes_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // Names of the files in the folder, for "nothing was left behind".
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  // Runs the indexer on this test's database.
  RunResult run(std::vector<std::string> arguments, const RunOptions& options = {}) const {
    arguments.insert(arguments.begin(), {"--db", db_});
    return run_program("landmarkdb-indexer", arguments, options);
  }
  // The same with --json; the test fails unless the status is as given and the output is JSON.
  nlohmann::json run_json(std::vector<std::string> arguments, int status = 0) const {
    arguments.emplace_back("--json");
    const RunResult result = run(std::move(arguments));
    EXPECT_EQ(result.status, status) << result.out << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  void add(const std::string& name) const {
    const RunResult result = run({"add", name, scan(), "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
  }
  // What the database holds, for "as it was before".
  nlohmann::json contents() const { return run_json({"list"}); }

  std::filesystem::path folder_;
  std::string db_;

 private:
  struct SyntheticRoom {
    std::vector<PointCloud> clouds =
        landmarkdb::testing::make_scene(
            {.furniture = 8, .stations = 2, .rays = 12'000, .room_m = {4.0, 3.0, 2.5}})
            .scans;
  };
  static std::vector<PointCloud>& shared_room() {
    static std::vector<PointCloud> clouds;
    return clouds;
  }
};

}  // namespace landmarkdb::indexer::testing
