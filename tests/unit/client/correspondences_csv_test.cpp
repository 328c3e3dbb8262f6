#include "client/correspondences_csv.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

CorrespondenceRecord pair(const std::string& scene, const std::string& dropped_by) {
  return {.scene = scene,
          .sensor_m = {0.1F, -2.0F, 3.0F},
          .scene_m = {1.0 / 3.0, 5.0, 6.0},
          .distance = 0.25F,
          .dropped_by = dropped_by};
}

TEST(CorrespondencesCsv, WritesALineAPairUnderAHeader) {
  EXPECT_EQ(
      correspondences_csv({pair("lobby", ""), pair("lobby", "ratio")}),
      "scene,sensor_x_m,sensor_y_m,sensor_z_m,scene_x_m,scene_y_m,scene_z_m,distance,dropped_by\n"
      "lobby,0.1,-2,3,0.3333333333333333,5,6,0.25,\n"
      "lobby,0.1,-2,3,0.3333333333333333,5,6,0.25,ratio\n");
}

TEST(CorrespondencesCsv, QuotesNamesThatNeedIt) {
  EXPECT_THAT(correspondences_csv({pair("a,\"b\"", "")}), ::testing::HasSubstr("\"a,\"\"b\"\"\","));
}

TEST(WriteCorrespondences, NamesTheFileThatCannotBeWritten) {
  try {
    write_correspondences("/nowhere/pairs.csv", {});
    FAIL() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nowhere/pairs.csv"));
  }
}

// Stopped in the middle, the file that was there used to be lost.
TEST(WriteCorrespondences, LeavesTheFileThatWasThereToItsReaders) {
  std::string name = (std::filesystem::temp_directory_path() / "landmarkdb-XXXXXX").string();
  ::close(::mkstemp(name.data()));
  std::ofstream(name) << "before";
  std::ifstream reader(name);
  write_correspondences(name, {pair("lobby", "")});
  std::string text;
  reader >> text;
  EXPECT_EQ(text, "before");
  EXPECT_GT(std::filesystem::file_size(name), 100U);
  std::filesystem::remove(name);
}

TEST(WriteCorrespondences, NoticesAFullDisk) {
  const std::vector<CorrespondenceRecord> many(20'000, pair("lobby", "ratio"));
  EXPECT_THROW(write_correspondences("/dev/full", many), Error);
}

}  // namespace
}  // namespace landmarkdb::client
