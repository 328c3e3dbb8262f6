#include "store/output_file.hpp"

#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using testing::read_file;
using testing::TempFolder;
using testing::write_file;

TEST(WriteNewFile, TakesItsNameOnlyWhenWhole) {
  const TempFolder folder;
  const std::string path = folder.file("out");
  write_new_file(path, [&](const std::string& temporary) {
    write_file(temporary, "half");
    EXPECT_FALSE(std::filesystem::exists(path));
    write_file(temporary, "whole");
  });
  EXPECT_EQ(read_file(path), "whole");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteNewFile, LeavesNothingWhenTheWritingFails) {
  const TempFolder folder;
  EXPECT_THROW(write_new_file(folder.file("out"),
                              [](const std::string& temporary) {
                                write_file(temporary, "half");
                                throw Error(ErrorCode::kCancelled, "stopped");
                              }),
               Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteNewFile, NeverReplacesWhatIsThereOrComesMeanwhile) {
  const TempFolder folder;
  const std::string path = folder.file("out");
  const auto thrown = error_of([&] {
    write_new_file(path, [&](const std::string& temporary) {
      write_file(temporary, "mine");
      write_file(path, "theirs");
    });
  });
  EXPECT_EQ(thrown.code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(read_file(path), "theirs");
  bool called = false;
  EXPECT_EQ(
      error_of([&] { write_new_file(path, [&](const std::string&) { called = true; }); }).code,
      ErrorCode::kAlreadyExists);
  EXPECT_FALSE(called);
  // A link that leads nowhere is something too.
  std::filesystem::create_symlink("nowhere", folder.file("link"));
  EXPECT_EQ(error_of([&] { write_new_file(folder.file("link"), [](const std::string&) {}); }).code,
            ErrorCode::kAlreadyExists);
}

}  // namespace
}  // namespace landmarkdb
