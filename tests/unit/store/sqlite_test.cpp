#include "store/sqlite.hpp"

#include "store/sqlite_error.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb::sqlite {
namespace {

using namespace std::chrono_literals;
using landmarkdb::testing::error_of;
using landmarkdb::testing::TempFolder;
using ::testing::HasSubstr;

Database memory() { return Database(":memory:", OpenMode::kCreate, 0ms); }

TEST(SqliteStatement, GivesBackWhatWasBound) {
  const Database database = memory();
  database.execute("CREATE TABLE t (i, r, s, b, n)");
  const std::vector<std::byte> blob{std::byte{0}, std::byte{255}};
  Statement insert(database, "INSERT INTO t VALUES (?, ?, ?, ?, ?)");
  insert.bind(std::int64_t{-7}).bind(0.1).bind("a'b").bind(std::span(blob)).bind_null().run();
  insert.bind(std::int64_t{8}).bind(0.0).bind("").bind(std::span<const std::byte>()).bind_null();
  insert.run();
  Statement rows(database, "SELECT * FROM t ORDER BY i");
  ASSERT_TRUE(rows.step());
  EXPECT_EQ(rows.integer(0), -7);
  EXPECT_EQ(rows.real(1), 0.1);
  EXPECT_EQ(rows.text(2), "a'b");
  EXPECT_EQ(std::vector<std::byte>(rows.blob(3).begin(), rows.blob(3).end()), blob);
  EXPECT_TRUE(rows.is_null(4));
  ASSERT_TRUE(rows.step());
  EXPECT_FALSE(rows.is_null(2));  // an empty text is no null
  EXPECT_FALSE(rows.is_null(3));
  EXPECT_TRUE(rows.blob(3).empty());
  EXPECT_FALSE(rows.step());
}

TEST(SqliteTransaction, IsRolledBackUnlessCommitted) {
  const Database database = memory();
  database.execute("CREATE TABLE t (i)");
  {
    const Transaction transaction(database, Transaction::Kind::kWrite);
    database.execute("INSERT INTO t VALUES (1)");
  }
  EXPECT_EQ(database.integer("SELECT count(*) FROM t"), 0);
  {
    Transaction transaction(database, Transaction::Kind::kWrite);
    database.execute("INSERT INTO t VALUES (1)");
    transaction.commit();
  }
  EXPECT_EQ(database.integer("SELECT count(*) FROM t"), 1);
}

TEST(SqliteDatabase, ChecksForeignKeys) {
  const Database database = memory();
  database.execute("CREATE TABLE a (id INTEGER PRIMARY KEY)");
  database.execute("CREATE TABLE b (a_id REFERENCES a (id))");
  EXPECT_THROW(database.execute("INSERT INTO b VALUES (1)"), Error);
}

TEST(SqliteInterruptGuard, StopsAStatement) {
  const Database database = memory();
  std::stop_source source;
  RunContext context;
  context.stop = source.get_token();
  const InterruptGuard guard(database, context);
  source.request_stop();
  const auto thrown = error_of([&] {
    database.integer(
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT max(i) FROM n");
  });
  EXPECT_EQ(thrown.code, ErrorCode::kCancelled);
}

TEST(SqliteErrors, ALockedFileIsUnavailable) {
  const TempFolder folder;
  const Database first(folder.file("x.db"), OpenMode::kCreate, 0ms);
  first.execute("CREATE TABLE t (i)");
  const Database second(folder.file("x.db"), OpenMode::kReadWrite, 10ms);
  const Transaction transaction(first, Transaction::Kind::kWrite);
  const auto thrown = error_of([&] { second.execute("INSERT INTO t VALUES (1)"); });
  EXPECT_EQ(thrown.code, ErrorCode::kUnavailable);
  EXPECT_THAT(thrown.message, HasSubstr("another process is writing to '" + folder.file("x.db")));
}

TEST(SqliteErrors, AFullFileIsResourceExhausted) {
  const Database database = memory();
  database.execute("CREATE TABLE t (b); PRAGMA max_page_count = 10");
  const auto thrown =
      error_of([&] { database.execute("INSERT INTO t VALUES (zeroblob(1000000))"); });
  EXPECT_EQ(thrown.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(thrown.message, HasSubstr("the disk is full"));
}

TEST(SqliteErrors, WritingThroughAReadOnlyFileIsNotPermitted) {
  const TempFolder folder;
  Database(folder.file("x.db"), OpenMode::kCreate, 0ms).execute("CREATE TABLE t (i)");
  for (const OpenMode mode : {OpenMode::kReadOnly, OpenMode::kImmutable}) {
    const Database database(folder.file("x.db"), mode, 0ms);
    EXPECT_EQ(error_of([&] { database.execute("INSERT INTO t VALUES (1)"); }).code,
              ErrorCode::kPermissionDenied);
  }
}

TEST(SqliteErrors, AFolderThatIsNotThereIsNamed) {
  const auto thrown = error_of([] { Database("/no/such/folder/x.db", OpenMode::kCreate, 0ms); });
  EXPECT_EQ(thrown.code, ErrorCode::kUnavailable);
  EXPECT_THAT(thrown.message, HasSubstr("/no/such/folder/x.db"));
}

TEST(SqliteDatabase, TakesAnyFileNameAsItIs) {
  const TempFolder folder;
  for (const char* name : {"with space.db", "ha#sh?q=1&x%41.db", "Größe.db"}) {
    Database(folder.file(name), OpenMode::kCreate, 0ms).execute("CREATE TABLE t (i)");
    EXPECT_TRUE(std::filesystem::exists(folder.file(name))) << name;
    const Database read(folder.file(name), OpenMode::kImmutable, 0ms);
    EXPECT_EQ(read.integer("SELECT count(*) FROM t"), 0) << name;
  }
}

TEST(SqliteCopy, CopiesOneMomentWhileAnotherConnectionWrites) {
  const TempFolder folder;
  const Database from(folder.file("from.db"), OpenMode::kCreate, 0ms);
  from.execute("PRAGMA journal_mode = WAL; CREATE TABLE t (b)");
  for (int i = 0; i < 8; ++i) from.execute("INSERT INTO t VALUES (randomblob(1000000))");
  const Database writer(folder.file("from.db"), OpenMode::kReadWrite, 1000ms);
  {
    const Database to(folder.file("to.db"), OpenMode::kCreate, 0ms);
    int calls = 0;
    copy_database(from, to, [&](std::uint64_t, std::uint64_t) {
      ++calls;
      writer.execute("INSERT INTO t VALUES (1)");
    });
    EXPECT_GT(calls, 1);
  }
  const Database copy(folder.file("to.db"), OpenMode::kReadOnly, 0ms);
  EXPECT_EQ(copy.integer("SELECT count(*) FROM t"), 8);
  Statement check(copy, "PRAGMA integrity_check");
  ASSERT_TRUE(check.step());
  EXPECT_EQ(check.text(0), "ok");
}

}  // namespace
}  // namespace landmarkdb::sqlite
