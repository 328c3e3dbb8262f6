#include "cli/write_file.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::cli {
namespace {

namespace fs = std::filesystem;

class WriteFileTest : public ::testing::Test {
 protected:
  WriteFileTest() {
    std::string pattern = (fs::temp_directory_path() / "landmarkdb-XXXXXX").string();
    folder = ::mkdtemp(pattern.data());
  }
  ~WriteFileTest() override { fs::remove_all(folder); }
  static std::string read(const fs::path& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path).rdbuf();
    return bytes.str();
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

  fs::path folder;
};

TEST_F(WriteFileTest, MakesAFileAndLeavesNothingBesideIt) {
  write_file(folder / "a.csv", "one\n", "--out");
  EXPECT_EQ(read(folder / "a.csv"), "one\n");
  EXPECT_EQ(files(), 1U);
}

TEST_F(WriteFileTest, ReplacesAFileWholeAndKeepsItsPermissions) {
  write_file(folder / "a.csv", "a longer text\n", "--out");
  fs::permissions(folder / "a.csv", fs::perms(0640));
  std::ifstream reader(folder / "a.csv");  // whoever reads the old one goes on to read it
  write_file(folder / "a.csv", "two\n", "--out");
  EXPECT_EQ(read(folder / "a.csv"), "two\n");
  EXPECT_EQ(fs::status(folder / "a.csv").permissions(), fs::perms(0640));
  std::string line;
  std::getline(reader, line);
  EXPECT_EQ(line, "a longer text");
}

TEST_F(WriteFileTest, WritesThroughALinkAndLeavesItALink) {
  write_file(folder / "a.csv", "one\n", "--out");
  fs::create_symlink(folder / "a.csv", folder / "link");
  write_file(folder / "link", "two\n", "--out");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read(folder / "a.csv"), "two\n");
}

TEST_F(WriteFileTest, WritesToADevice) {
  EXPECT_NO_THROW(write_file("/dev/null", "gone", "--out"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(WriteFileTest, NamesWhatCannotBeWrittenAndLeavesNothing) {
  for (const fs::path& path : {folder / "missing" / "a.csv", folder, fs::path("/dev/full")}) {
    try {
      write_file(path, "text", "--out");
      ADD_FAILURE() << path << " was written";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
      EXPECT_EQ(error.field(), "--out");
      EXPECT_THAT(error.what(), ::testing::HasSubstr(path.string() + ": cannot be written: "));
    }
  }
  EXPECT_EQ(files(), 0U);
}

}  // namespace
}  // namespace landmarkdb::cli
