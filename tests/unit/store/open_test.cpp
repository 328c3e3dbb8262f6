#include "store/open.hpp"

#include <iostream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using sqlite::Database;
using sqlite::OpenMode;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_record;
using testing::read_file;
using testing::TempFolder;
using testing::write_file;

TEST(OpenDatabase, IsWrittenWithWalAndFullSynchronisation) {
  const TempFolder folder;
  const auto database = create_or_open_database(folder.file("x.db"), {});
  sqlite::Statement mode(*database, "PRAGMA journal_mode");
  ASSERT_TRUE(mode.step());
  EXPECT_EQ(mode.text(0), "wal");
  EXPECT_EQ(database->integer("PRAGMA synchronous"), 2);
  EXPECT_EQ(database->integer("PRAGMA foreign_keys"), 1);
  EXPECT_EQ(database->integer("PRAGMA application_id"), kApplicationId);
}

TEST(OpenDatabase, OneThatIsNotThereIsNotMade) {
  const TempFolder folder;
  for (const bool read_only : {true, false}) {
    const auto thrown = error_of([&] { open_database(folder.file("x.db"), read_only, {}); });
    EXPECT_EQ(thrown.code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(thrown.message, HasSubstr("does not exist"));
    EXPECT_FALSE(std::filesystem::exists(folder.file("x.db")));
  }
}

TEST(OpenDatabase, WhatIsNoDatabaseIsRefusedAndLeftAlone) {
  const TempFolder folder;
  for (const std::string& bytes : {std::string("VERSION .7\nFIELDS x y z\n"),
                                   std::string(5000, '\xff'),
                                   std::string("SQLite"),
                                   std::string("SQLite format 3\0", 16) + std::string(84, 'x'),
                                   std::string("SQLite format 3\0", 16)}) {
    write_file(folder.file("x.db"), bytes);
    for (const auto& open : {+[](const std::string& p) { Store::open_read_only(p); },
                             +[](const std::string& p) { Store::open_read_write(p); },
                             +[](const std::string& p) { Store::create_or_open(p); },
                             +[](const std::string& p) { Store::migrate(p, false, {}); }}) {
      const auto thrown = error_of([&] { open(folder.file("x.db")); });
      EXPECT_TRUE(thrown.code == ErrorCode::kInvalidArgument || thrown.code == ErrorCode::kDataLoss)
          << thrown.message;
      EXPECT_THAT(thrown.message, HasSubstr("x.db"));
    }
    EXPECT_EQ(read_file(folder.file("x.db")), bytes);
  }
}

TEST(OpenDatabase, AFolderOrAnEmptyNameIsRefused) {
  const TempFolder folder;
  EXPECT_EQ(error_of([&] { Store::create_or_open(folder.path()); }).code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([&] { Store::create_or_open(""); }).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([&] { Store::create_or_open(std::string("a\0b", 3)); }).code,
            ErrorCode::kInvalidArgument);
}

TEST(OpenDatabase, AnotherProgramsSqliteFileIsRefusedAndLeftAlone) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Database(path, OpenMode::kCreate, 0ms)
      .execute("CREATE TABLE theirs (i); INSERT INTO theirs VALUES (1)");
  const std::string before = read_file(path);
  const auto thrown = error_of([&] { Store::create_or_open(path); });
  EXPECT_EQ(thrown.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(thrown.message, HasSubstr("not a landmarkdb database"));
  EXPECT_EQ(read_file(path), before);
}

TEST(OpenDatabase, WhatAKilledCreationLeftIsMadeWhole) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Database(path, OpenMode::kCreate, 0ms).execute("PRAGMA journal_mode = WAL");
  EXPECT_TRUE(Store::create_or_open(path).check({}).ok());
  write_file(folder.file("empty.db"), "");
  EXPECT_TRUE(Store::create_or_open(folder.file("empty.db")).check({}).ok());
}

TEST(OpenDatabase, ATruncatedFileIsAnErrorWhereverItIsCut) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert(make_record("lobby"), {});
  const std::string whole = read_file(path);
  for (const std::size_t size : {std::size_t{10},
                                 std::size_t{99},
                                 std::size_t{1000},
                                 std::size_t{16384},
                                 whole.size() / 2,
                                 whole.size() - 16384}) {
    const std::string cut = folder.file("cut.db");
    write_file(cut, whole.substr(0, size));
    bool seen = false;
    try {
      Store store = Store::open_read_only(cut);
      seen = !store.check({}).ok();
    } catch (const Error& error) {
      seen = true;
      EXPECT_TRUE(error.code() == ErrorCode::kDataLoss ||
                  error.code() == ErrorCode::kInvalidArgument)
          << error.what();
    }
    EXPECT_TRUE(seen) << size;
    std::filesystem::remove(cut + "-wal");
    std::filesystem::remove(cut + "-shm");
  }
}

TEST(OpenDatabase, ReadingNeverChangesTheFile) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  {
    Store store = Store::create_or_open(path);
    for (const char* name : {"a", "b", "c"}) store.insert(make_record(name), {});
  }
  const std::string before = read_file(path);
  for (int i = 0; i < 20; ++i) {
    Store store = Store::open_read_only(path);
    EXPECT_EQ(store.load_catalog({})->entries.size(), 3U);
    EXPECT_EQ(store.list_scenes().size(), 3U);
    EXPECT_TRUE(store.check({}).ok());
  }
  EXPECT_EQ(read_file(path), before);
}

// Runs `job` in a child that has no rights of its own; true when it did and threw nothing.
template <typename Job>
bool without_rights(const Job& job) {
  const pid_t child = fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (getuid() == 0 && setuid(kNobody) != 0) _exit(3);
    int status = 0;
    try {
      job();
    } catch (const std::exception& error) {
      std::cerr << error.what() << "\n";
      status = 1;
    }
    _exit(status);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(OpenDatabase, CanBeReadFromAFolderThatMayNotBeWritten) {
  namespace fs = std::filesystem;
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert(make_record("lobby"), {});
  fs::permissions(path, fs::perms(0444));
  fs::permissions(folder.path(), fs::perms(0555));
  EXPECT_TRUE(without_rights([&] {
    const Store store = Store::open_read_only(path);
    if (store.load_catalog({})->entries.size() != 1) throw std::runtime_error("not read");
    if (store.warnings().size() != 1) throw std::runtime_error("not warned");
  }));
  EXPECT_TRUE(without_rights([&] {
    const auto thrown = error_of([&] { Store::open_read_write(path).remove("lobby"); });
    if (thrown.code != ErrorCode::kPermissionDenied) throw std::runtime_error(thrown.message);
  }));
  fs::permissions(folder.path(), fs::perms(0755));
}

// Asks the system, in a process of its own: SQLite's tables in this one would not know.
bool is_locked(const std::string& path) {
  const pid_t child = fork();
  if (child == 0) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;  // from 0 to the end
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0 || fcntl(descriptor, F_GETLK, &lock) != 0) _exit(2);
    _exit(lock.l_type == F_UNLCK ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

// A lock of this process goes with any descriptor of the file that the process closes.
TEST(OpenDatabase, OpeningAgainLeavesTheLocksOfAnOpenConnection) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path);
  const Database holder(path, OpenMode::kReadWrite, 0ms);
  holder.execute("PRAGMA journal_mode = DELETE");  // its locks are on the file itself
  EXPECT_FALSE(is_locked(path));
  const sqlite::Transaction transaction(holder, sqlite::Transaction::Kind::kWrite);
  ASSERT_TRUE(is_locked(path));
  Store::open_read_only(path, {.busy_timeout = 0ms});
  EXPECT_TRUE(is_locked(path));
  EXPECT_THROW(Store::open_read_write(path, {.busy_timeout = 0ms}), Error);
  EXPECT_THROW(Store::create_or_open(path, {.busy_timeout = 0ms}), Error);
  Store::migrate(path, true, {});
  EXPECT_TRUE(is_locked(path));
}

TEST(OpenDatabase, OfTwoThatMakeItAtOnceBothGetIt) {
  for (int round = 0; round < 10; ++round) {
    const TempFolder folder;
    const std::string path = folder.file("x.db");
    std::vector<std::jthread> makers;
    for (const char* name : {"a", "b", "c"}) {
      makers.emplace_back([&path, name] {
        EXPECT_NO_THROW(Store::create_or_open(path).insert(make_record(name), {}));
      });
    }
    makers.clear();
    EXPECT_EQ(Store::open_read_only(path).list_scenes().size(), 3U);
  }
}

TEST(OpenDatabase, AWriterOfAnotherSizeLimitIsStopped) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"), {.max_bytes = 500'000});
  const auto thrown = error_of(
      [&] { store.insert(make_record("big", 1, {.points = 50'000, .keypoints = 100}), {}); });
  EXPECT_EQ(thrown.code, ErrorCode::kResourceExhausted);
  EXPECT_TRUE(store.list_scenes().empty());
  EXPECT_TRUE(store.check({}).ok());
}

TEST(LocationWarnings, TellThatChangesCannotBeSeen) {
  const TempFolder folder;
  EXPECT_TRUE(Store::create_or_open(folder.file("x.db")).warnings().empty());
  const Database database(folder.file("x.db"), OpenMode::kImmutable, 0ms);
  EXPECT_THAT(location_warnings(database), ::testing::ElementsAre(HasSubstr("may not be written")));
}

}  // namespace
}  // namespace landmarkdb
