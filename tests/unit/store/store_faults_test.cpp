// A change that cannot be finished leaves the database as it was.
#include <atomic>
#include <csignal>
#include <thread>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "store/sqlite.hpp"
#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_record;
using testing::read_file;
using testing::TempFolder;

constexpr testing::RecordSize kSeveralChunks{.points = 400'000, .keypoints = 10};

// A database with one scene, and what must still hold of it.
class StoreFaults : public ::testing::Test {
 protected:
  StoreFaults() { Store::create_or_open(path_).insert(make_record("lobby"), {}); }

  void expect_as_before() const {
    const Store store = Store::open_read_only(path_);
    ASSERT_EQ(store.list_scenes().size(), 1U);
    EXPECT_EQ(store.show("lobby").versions.size(), 1U);
    EXPECT_EQ(store.generation(), 1U);
    EXPECT_THAT(store.check({}).findings, ::testing::IsEmpty());
    testing::expect_same_record(*store.load("lobby"), make_record("lobby"));
  }

  TempFolder folder_;
  std::string path_ = folder_.file("x.db");
};

TEST_F(StoreFaults, AStopRequestBetweenChunks) {
  std::stop_source source;
  RunContext context;
  context.stop = source.get_token();
  int reports = 0;
  context.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "store");
    if (++reports == 3) source.request_stop();
  };
  Store store = Store::open_read_write(path_);
  const auto thrown =
      error_of([&] { store.insert(make_record("lobby", 3, kSeveralChunks), context); });
  EXPECT_EQ(thrown.code, ErrorCode::kCancelled);
  expect_as_before();
  // The same Store goes on working.
  EXPECT_EQ(store.insert(make_record("lobby"), {}).version, 2);
}

TEST_F(StoreFaults, ADeadlineThatPasses) {
  RunContext context;
  context.deadline = std::chrono::steady_clock::now() - 1s;
  Store store = Store::open_read_write(path_);
  EXPECT_EQ(error_of([&] { store.insert(make_record("office"), context); }).code,
            ErrorCode::kDeadlineExceeded);
  expect_as_before();
}

TEST_F(StoreFaults, AFullDatabase) {
  Store store = Store::open_read_write(path_, {.max_bytes = 1'000'000});
  const auto thrown = error_of([&] { store.insert(make_record("big", 3, kSeveralChunks), {}); });
  EXPECT_EQ(thrown.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(thrown.message, HasSubstr("full"));
  expect_as_before();
  EXPECT_EQ(exit_status(thrown.code), 8);
}

TEST_F(StoreFaults, AFileThatMayNotGrow) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // As a full disk, but of this process alone: writes past the limit fail.
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1'000'000, 1'000'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    int status = 1;
    try {
      Store::open_read_write(path_).insert(make_record("big", 3, kSeveralChunks), {});
    } catch (const Error& error) {
      status = error.code() == ErrorCode::kResourceExhausted ? 0 : 2;
    }
    _exit(status);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  expect_as_before();
}

class StoreKilled : public StoreFaults, public ::testing::WithParamInterface<int> {};

TEST_P(StoreKilled, InTheMiddleOfAnInsert) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    int reports = 0;
    RunContext context;
    context.progress = [&](const Progress&) {
      if (++reports == GetParam()) kill(getpid(), SIGKILL);
    };
    Store::open_read_write(path_).insert(make_record("lobby", 3, kSeveralChunks), context);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
  expect_as_before();
  EXPECT_EQ(Store::open_read_write(path_).insert(make_record("lobby"), {}).version, 2);
}

// Reports come before each chunk and after the last: nine chunks, ten reports.
INSTANTIATE_TEST_SUITE_P(AtEachStep, StoreKilled, ::testing::Values(1, 2, 5, 10));

TEST_F(StoreFaults, ASecondWriterIsToldSo) {
  const sqlite::Database other(path_, sqlite::OpenMode::kReadWrite, 0ms);
  Store store = Store::open_read_write(path_, {.busy_timeout = 20ms});
  {
    const sqlite::Transaction writing(other, sqlite::Transaction::Kind::kWrite);
    const auto thrown = error_of([&] { store.insert(make_record("office"), {}); });
    EXPECT_EQ(thrown.code, ErrorCode::kUnavailable);
    EXPECT_THAT(thrown.message, HasSubstr("another process is writing"));
    // Readers are not held up.
    EXPECT_EQ(Store::open_read_only(path_).load_catalog({})->entries.size(), 1U);
  }
  expect_as_before();
  EXPECT_NO_THROW(store.insert(make_record("office"), {}));
}

TEST_F(StoreFaults, TwoWritersTakeTurns) {
  std::vector<std::jthread> writers;
  for (int w = 0; w < 2; ++w) {
    writers.emplace_back([this, w] {
      Store store = Store::open_read_write(path_);
      for (int i = 0; i < 5; ++i) {
        store.insert(make_record("w" + std::to_string(w) + "-" + std::to_string(i)), {});
      }
    });
  }
  writers.clear();
  const Store store = Store::open_read_only(path_);
  EXPECT_EQ(store.list_scenes().size(), 11U);
  EXPECT_EQ(store.generation(), 11U);
  EXPECT_TRUE(store.check({}).ok());
}

TEST_F(StoreFaults, ABackupIsWholeWhileAnotherWrites) {
  std::atomic<bool> done = false;
  std::jthread writer([&] {
    Store store = Store::open_read_write(path_);
    for (int i = 0; i < 20 && !done; ++i) {
      store.insert(make_record("s" + std::to_string(i), 1, {.points = 20'000}), {});
    }
  });
  {
    const Store store = Store::open_read_only(path_);
    for (int i = 0; i < 3; ++i) store.backup(folder_.file("b" + std::to_string(i)), {});
  }
  done = true;
  writer.join();
  for (int i = 0; i < 3; ++i) {
    const Store copy = Store::open_read_only(folder_.file("b" + std::to_string(i)));
    EXPECT_TRUE(copy.check({}).ok());
    EXPECT_EQ(copy.list_scenes().size(), copy.generation());
  }
}

TEST_F(StoreFaults, ABackupNeverWritesOverAFile) {
  testing::write_file(folder_.file("mine.txt"), "precious");
  const Store store = Store::open_read_only(path_);
  const auto thrown = error_of([&] { store.backup(folder_.file("mine.txt"), {}); });
  EXPECT_EQ(thrown.code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(read_file(folder_.file("mine.txt")), "precious");
  EXPECT_EQ(error_of([&] { store.backup(path_, {}); }).code, ErrorCode::kAlreadyExists);
  EXPECT_EQ(error_of([&] { store.backup("/no/such/folder/x", {}); }).code,
            ErrorCode::kInvalidArgument);
}

TEST_F(StoreFaults, AStoppedBackupLeavesNoFile) {
  RunContext context;
  std::stop_source source;
  context.stop = source.get_token();
  context.progress = [&](const Progress&) { source.request_stop(); };
  const Store store = Store::open_read_only(path_);
  EXPECT_EQ(error_of([&] { store.backup(folder_.file("b"), context); }).code,
            ErrorCode::kCancelled);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_TRUE(entry.path().filename().string().starts_with("x.db")) << entry.path();
  }
}

}  // namespace
}  // namespace landmarkdb
