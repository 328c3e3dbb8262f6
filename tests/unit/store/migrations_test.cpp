#include "store/migrations.hpp"

#include "store/open.hpp"
#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using namespace std::chrono_literals;
using sqlite::Database;
using sqlite::OpenMode;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_record;
using testing::TempFolder;

// What a later version will bring: one more table.
std::vector<Migration> with_next(std::string_view sql) {
  std::vector<Migration> migrations(all_migrations().begin(), all_migrations().end());
  migrations.push_back({schema_version() + 1, "next", sql});
  return migrations;
}

// A database at `version`: what a program of that time wrote.
void make_database_of_version(const std::string& path, int version) {
  const Database database(path, OpenMode::kCreate, 0ms);
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  apply_migrations(database, all_migrations().first(static_cast<std::size_t>(version)));
}

TEST(Migrations, AreNumberedFromOneWithoutGaps) {
  int want = 0;
  for (const Migration& migration : all_migrations()) EXPECT_EQ(migration.version, ++want);
  EXPECT_EQ(schema_version(), want);
  EXPECT_GE(want, 1);
}

TEST(Migrations, EveryOlderVersionIsBroughtUpToDate) {
  for (int version = 0; version < schema_version(); ++version) {
    const TempFolder folder;
    const std::string path = folder.file("old.db");
    make_database_of_version(path, version);

    const auto refused = error_of([&] { Store::open_read_only(path); });
    EXPECT_EQ(refused.code, ErrorCode::kUnimplemented);
    EXPECT_THAT(refused.message, HasSubstr("migrate"));
    EXPECT_THAT(refused.message, HasSubstr("version " + std::to_string(version)));
    EXPECT_EQ(error_of([&] { Store::create_or_open(path); }).code, ErrorCode::kUnimplemented);

    const MigrationReport plan = Store::migrate(path, true, {});
    EXPECT_EQ(plan.from_version, version);
    EXPECT_EQ(plan.steps.size(), static_cast<std::size_t>(schema_version() - version));
    EXPECT_TRUE(plan.backup_path.empty());
    EXPECT_THROW(Store::open_read_only(path), Error);

    const MigrationReport done = Store::migrate(path, false, {});
    EXPECT_EQ(done.steps, plan.steps);
    EXPECT_TRUE(std::filesystem::exists(done.backup_path));
    Store store = Store::open_read_write(path);
    store.insert(make_record("lobby"), {});
    EXPECT_TRUE(store.check({}).ok());
  }
}

TEST(Migrations, AFileThatVersion1WroteKeepsItsSceneAndTakesModels) {
  const TempFolder folder;
  const std::string path = folder.file("old.db");
  {
    const Database database(path, OpenMode::kCreate, 0ms);
    database.execute(testing::read_file(LANDMARKDB_VERSION1_SQL));
    database.execute("PRAGMA application_id = " + std::to_string(kApplicationId) +
                     "; PRAGMA user_version = 1");
  }
  EXPECT_EQ(error_of([&] { Store::open_read_only(path); }).code, ErrorCode::kUnimplemented);
  const std::string before = testing::read_file(path);
  const MigrationReport plan = Store::migrate(path, true, {});
  EXPECT_THAT(plan.steps, ElementsAre("0002_mono", "0003_scene_index", "0004_scene_index_parts"));
  EXPECT_EQ(testing::read_file(path), before);

  const MigrationReport done = Store::migrate(path, false, {});
  EXPECT_EQ(done.from_version, 1);
  EXPECT_EQ(done.backup_path, path + ".v1.backup");
  const Database backup(done.backup_path, OpenMode::kReadOnly, 0ms);
  EXPECT_EQ(user_version(backup), 1);
  Store store = Store::open_read_write(path);
  EXPECT_THAT(store.check({}).findings, ::testing::IsEmpty());
  EXPECT_EQ(store.show("lobby").versions.size(), 2U);
  EXPECT_EQ(store.show("lobby").tags.at("floor"), "2");
  EXPECT_EQ(store.load("lobby")->prepared.size(), 12U);
  EXPECT_EQ(store.rollback("lobby"), 1);
  EXPECT_THAT(store.list_models(), ::testing::IsEmpty());
}

TEST(Migrations, SearchIndexesOfVersion3AreDroppedAndMadeAnew) {
  const TempFolder folder;
  const std::string path = folder.file("old.db");
  {
    const Database database(path, OpenMode::kCreate, 0ms);
    apply_migrations(database, all_migrations().first(3));
    database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
    database.execute(
        "INSERT INTO segment (id, format, bytes, manifest, sha256) VALUES (1, 1, 0, '{}', '" +
        std::string(64, 'a') +
        "'); INSERT INTO scene_index (segment_id, version, params, codes, digest) "
        "VALUES (1, 2, 'of before', x'01', '" +
        std::string(64, 'b') + "')");
  }
  EXPECT_THAT(Store::migrate(path, false, {}).steps, ElementsAre("0004_scene_index_parts"));
  const Database database(path, OpenMode::kReadOnly, 0ms);
  EXPECT_EQ(database.integer("SELECT count(*) FROM segment"), 1);
  EXPECT_EQ(database.integer("SELECT count(*) FROM scene_index"), 0);
}

TEST(Migrations, ACurrentDatabaseIsLeftAlone) {
  const TempFolder folder;
  Store::create_or_open(folder.file("x.db"));
  const std::string before = testing::read_file(folder.file("x.db"));
  const MigrationReport report = Store::migrate(folder.file("x.db"), false, {});
  EXPECT_TRUE(report.steps.empty());
  EXPECT_TRUE(report.backup_path.empty());
  EXPECT_EQ(testing::read_file(folder.file("x.db")), before);
}

TEST(Migrations, KeepTheScenesAndABackupOfTheOldFile) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert(make_record("lobby"), {});
  const auto report =
      migrate_database(path, false, with_next("CREATE TABLE later (i INTEGER) STRICT;"), {});
  EXPECT_THAT(report.steps, ElementsAre("next"));
  EXPECT_EQ(report.backup_path, path + ".v" + std::to_string(schema_version()) + ".backup");
  EXPECT_EQ(Store::open_read_only(report.backup_path).list_scenes().size(), 1U);
  const Database after(path, OpenMode::kReadOnly, 0ms);
  EXPECT_EQ(after.integer("SELECT count(*) FROM scene"), 1);
  EXPECT_EQ(user_version(after), schema_version() + 1);
}

TEST(Migrations, OneThatFailsLeavesTheVersionBefore) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert(make_record("lobby"), {});
  const auto broken = with_next("CREATE TABLE later (i INTEGER) STRICT; SELECT no_such_thing();");
  EXPECT_THROW(migrate_database(path, false, broken, {}), Error);
  Store store = Store::open_read_only(path);
  EXPECT_EQ(store.list_scenes().size(), 1U);
  EXPECT_TRUE(store.check({}).ok());
}

TEST(Migrations, ANewerDatabaseIsRefusedWithBothVersions) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path);
  Database(path, OpenMode::kReadWrite, 0ms).execute("PRAGMA user_version = 99");
  for (const auto& open : {+[](const std::string& p) { Store::open_read_only(p); },
                           +[](const std::string& p) { Store::open_read_write(p); },
                           +[](const std::string& p) { Store::create_or_open(p); },
                           +[](const std::string& p) { Store::migrate(p, false, {}); }}) {
    const auto thrown = error_of([&] { open(path); });
    EXPECT_EQ(thrown.code, ErrorCode::kUnimplemented);
    EXPECT_THAT(thrown.message, HasSubstr("version 99"));
    EXPECT_THAT(thrown.message, HasSubstr("reads " + std::to_string(schema_version())));
  }
}

}  // namespace
}  // namespace landmarkdb
