#include "store/output_file.hpp"

#include <unistd.h>

#include "store/store.hpp"
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

TEST(WriteNewFile, DoesNotWriteThroughALinkLaidInItsWay) {
  const TempFolder folder;
  write_file(folder.file("theirs"), "theirs");
  std::filesystem::create_symlink("theirs",
                                  folder.file("out.partial-" + std::to_string(getpid()) + "-0"));
  write_new_file(folder.file("out"),
                 [](const std::string& temporary) { write_file(temporary, "mine"); });
  EXPECT_EQ(read_file(folder.file("out")), "mine");
  EXPECT_EQ(read_file(folder.file("theirs")), "theirs");
}

TEST(TakeName, NeverReplacesAnything) {
  const TempFolder folder;
  write_file(folder.file("a"), "a");
  write_file(folder.file("b"), "b");
  EXPECT_FALSE(take_name(folder.file("a"), folder.file("b")));
  EXPECT_EQ(read_file(folder.file("b")), "b");
  EXPECT_TRUE(take_name(folder.file("a"), folder.file("c")));
  EXPECT_EQ(read_file(folder.file("c")), "a");
  EXPECT_EQ(error_of([&] { take_name(folder.file("none"), folder.file("d")); }).code,
            ErrorCode::kInvalidArgument);
}

TEST(BackupDatabase, KeepsThePermissionsOfTheSource) {
  namespace fs = std::filesystem;
  const TempFolder folder;
  const Store store = Store::create_or_open(folder.file("x.db"));
  for (const auto mode : {fs::perms(0600), fs::perms(0664)}) {
    fs::permissions(folder.file("x.db"), mode);
    const std::string copy = folder.file("copy" + std::to_string(static_cast<int>(mode)));
    store.backup(copy, {});
    EXPECT_EQ(fs::status(copy).permissions(), mode);
  }
}

}  // namespace
}  // namespace landmarkdb
