#include "indexer/new_database.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::indexer {
namespace {

namespace fs = std::filesystem;

class NewDatabase : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("landmarkdb_new_" + std::to_string(::getpid()) + '_' + test->name());
    fs::create_directory(folder_);
    path_ = (folder_ / "site.db").string();
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
  std::string path_;
};

TEST_F(NewDatabase, IsMadeByAChangeThatWorks) {
  change_or_create(path_, [](Store&) { return InsertResult{}; });
  EXPECT_EQ(file_count(), 1U);
  EXPECT_TRUE(Store::open_read_only(path_).list_scenes().empty());
}

TEST_F(NewDatabase, IsNotMadeByAChangeThatFails) {
  EXPECT_THROW(change_or_create(path_,
                                [](Store&) -> InsertResult {
                                  throw Error(ErrorCode::kResourceExhausted, "the disk is full");
                                }),
               Error);
  EXPECT_EQ(file_count(), 0U);
}

TEST_F(NewDatabase, GivesWayToOneThatSomeoneElseMadeMeanwhile) {
  int calls = 0;
  change_or_create(path_, [&](Store&) {
    if (++calls == 1) Store::create_or_open(path_);
    return InsertResult{};
  });
  EXPECT_EQ(calls, 2);  // the second time on the other's file
  EXPECT_EQ(file_count(), 1U);
}

TEST_F(NewDatabase, IsRefusedBeforehandWhereItCannotBe) {
  EXPECT_NO_THROW(require_writable_database(path_));
  EXPECT_EQ(file_count(), 0U);
  EXPECT_THROW(require_writable_database((folder_ / "none" / "site.db").string()), Error);
  std::ofstream(path_) << "a text that is no database, and long enough to have a header";
  EXPECT_THROW(require_writable_database(path_), Error);
}

TEST_F(NewDatabase, AnEmptyFileIsTakenAsNone) {
  std::ofstream{path_};
  EXPECT_NO_THROW(require_writable_database(path_));
  EXPECT_EQ(fs::file_size(path_), 0U);
  EXPECT_THROW(change_or_create(path_,
                                [](Store&) -> InsertResult {
                                  throw Error(ErrorCode::kResourceExhausted, "the disk is full");
                                }),
               Error);
  EXPECT_EQ(fs::file_size(path_), 0U);
  change_or_create(path_, [](Store&) { return InsertResult{}; });
  EXPECT_EQ(file_count(), 1U);
  EXPECT_TRUE(Store::open_read_only(path_).list_scenes().empty());
}

}  // namespace
}  // namespace landmarkdb::indexer
