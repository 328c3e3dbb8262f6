#include "store/store.hpp"

#include <cmath>
#include <utility>

#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using testing::error_of;
using testing::expect_same_record;
using ::testing::HasSubstr;
using testing::make_record;
using ::testing::Pair;
using testing::TempFolder;

Store memory() { return Store::create_or_open(":memory:"); }

TEST(Store, GivesBackWhatWasInserted) {
  Store store = memory();
  const SceneRecord record = make_record("lobby");
  const InsertResult result = store.insert(record, {});
  EXPECT_EQ(result.version, 1);
  expect_same_record(*store.load("lobby"), record);
  expect_same_record(*store.load(result.scene_id), record);
}

TEST(Store, SplitsLargeArraysAndJoinsThemAgain) {
  Store store = memory();
  // 4.8 MB of points: two chunks.
  const SceneRecord record = make_record("lobby", 1, {.points = 400'000, .keypoints = 1});
  store.insert(record, {});
  EXPECT_EQ(store.load("lobby")->prepared.points, record.prepared.points);
}

TEST(Store, ListsScenesByNameWithWhatIsKnownOfThem) {
  Store store = memory();
  store.insert(make_record("office", 2), {});
  store.insert(make_record("lobby", 1), {});
  store.tag("lobby", "building", "7");
  store.add_landmark("lobby", {"air-vents", {0, 0, 0}, {1, 2, 3}});
  const auto scenes = store.list_scenes();
  ASSERT_EQ(scenes.size(), 2U);
  const SceneSummary& lobby = scenes[0];
  EXPECT_EQ(lobby.name, "lobby");
  EXPECT_EQ(lobby.kind, EntryKind::kPlace);
  EXPECT_EQ(lobby.active_version, 1);
  EXPECT_EQ(lobby.points, 200U);
  EXPECT_EQ(lobby.keypoints, 20U);
  EXPECT_EQ(lobby.bytes, 200U * 26U + 24U + 20U * (40U + 704U));
  EXPECT_EQ(lobby.options, make_record("lobby").options);
  EXPECT_EQ(lobby.up, Eigen::Vector3d(0, 0, 1));
  EXPECT_THAT(lobby.sources, ElementsAre("station 1.pcd", "Größe.ply"));
  EXPECT_THAT(lobby.warnings, ElementsAre("units_suspect"));
  EXPECT_THAT(lobby.tags, ElementsAre(Pair("building", "7")));
  ASSERT_EQ(lobby.landmarks.size(), 1U);
  EXPECT_EQ(lobby.landmarks[0].max_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(lobby.damage);
  EXPECT_EQ(scenes[1].kind, EntryKind::kObject);
  EXPECT_EQ(store.show("office").id, scenes[1].id);
}

TEST(Store, AnExistingNameGetsANewActiveVersion) {
  Store store = memory();
  const InsertResult first = store.insert(make_record("lobby", 1), {});
  const InsertResult second = store.insert(make_record("lobby", 3, {.points = 300}), {});
  EXPECT_EQ(second.scene_id, first.scene_id);
  EXPECT_EQ(second.version, 2);
  EXPECT_EQ(store.load("lobby")->prepared.size(), 300U);
  EXPECT_EQ(store.load("lobby", 1)->prepared.size(), 200U);
  const SceneSummary scene = store.show("lobby");
  ASSERT_EQ(scene.versions.size(), 2U);
  EXPECT_FALSE(scene.versions[0].active);
  EXPECT_FALSE(scene.versions[0].retired.empty());
  EXPECT_TRUE(scene.versions[1].active);
  EXPECT_TRUE(scene.versions[1].retired.empty());
}

TEST(Store, RollbackGoesBackOneVersionUntilThereIsNone) {
  Store store = memory();
  for (std::size_t points : {10, 20, 30}) {
    store.insert(make_record("lobby", 1, {.points = points}), {});
  }
  EXPECT_EQ(store.rollback("lobby"), 2);
  EXPECT_EQ(store.load("lobby")->prepared.size(), 20U);
  EXPECT_EQ(store.rollback("lobby"), 1);
  const auto thrown = error_of([&] { store.rollback("lobby"); });
  EXPECT_EQ(thrown.code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(thrown.message, HasSubstr("no earlier version"));
  EXPECT_EQ(store.show("lobby").active_version, 1);
  // A number that was given away is not used again.
  EXPECT_EQ(store.insert(make_record("lobby"), {}).version, 4);
}

TEST(Store, RemovesASceneWithAllThatBelongsToIt) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"));
  const std::int64_t id = store.insert(make_record("lobby"), {}).scene_id;
  store.insert(make_record("lobby"), {});
  store.tag("lobby", "a", "b");
  store.add_landmark("lobby", {"vent", {0, 0, 0}, {1, 1, 1}});
  store.remove("lobby");
  EXPECT_TRUE(store.list_scenes().empty());
  EXPECT_TRUE(store.check({}).ok());
  EXPECT_EQ(error_of([&] { store.remove("lobby"); }).code, ErrorCode::kNotFound);
  const InsertResult again = store.insert(make_record("lobby"), {});
  EXPECT_GT(again.scene_id, id);
  EXPECT_EQ(again.version, 1);
  EXPECT_TRUE(store.show("lobby").tags.empty());
}

TEST(Store, RenamesButNeverOntoAnotherScene) {
  Store store = memory();
  store.insert(make_record("lobby"), {});
  store.insert(make_record("office"), {});
  store.rename("lobby", "Empfang");
  EXPECT_EQ(store.load("Empfang")->name, "Empfang");
  const auto thrown = error_of([&] { store.rename("Empfang", "office"); });
  EXPECT_EQ(thrown.code, ErrorCode::kAlreadyExists);
  EXPECT_NO_THROW(store.rename("office", "office"));
  EXPECT_EQ(error_of([&] { store.rename("office", "a/b"); }).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([&] { store.rename("lobby", "x"); }).code, ErrorCode::kNotFound);
  EXPECT_EQ(store.list_scenes().size(), 2U);
}

TEST(Store, ABadNameIsRefusedBeforeAnythingIsWritten) {
  Store store = memory();
  EXPECT_EQ(error_of([&] { store.insert(make_record("a/b"), {}); }).code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(error_of([&] { store.insert(make_record(""), {}); }).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(store.generation(), 0U);
}

TEST(Store, TagsAreSetReplacedAndRemoved) {
  Store store = memory();
  store.insert(make_record("lobby"), {});
  store.tag("lobby", "floor", "1");
  store.tag("lobby", "floor", "2");
  EXPECT_THAT(store.show("lobby").tags, ElementsAre(Pair("floor", "2")));
  store.untag("lobby", "floor");
  EXPECT_TRUE(store.show("lobby").tags.empty());
  EXPECT_EQ(error_of([&] { store.untag("lobby", "floor"); }).code, ErrorCode::kNotFound);
  EXPECT_EQ(error_of([&] { store.tag("office", "a", "b"); }).code, ErrorCode::kNotFound);
  EXPECT_EQ(error_of([&] { store.tag("lobby", "", "b"); }).code, ErrorCode::kInvalidArgument);
}

TEST(Store, LandmarksAreAddedReplacedListedAndRemoved) {
  Store store = memory();
  store.insert(make_record("lobby"), {});
  store.add_landmark("lobby", {"vents", {0, 0, 0}, {1, 1, 1}});
  store.add_landmark("lobby", {"door", {-1, 0, 0}, {0, 1, 2}});
  store.add_landmark("lobby", {"vents", {0, 0, 0}, {2, 2, 2}});
  const auto landmarks = store.list_landmarks("lobby");
  ASSERT_EQ(landmarks.size(), 2U);
  EXPECT_EQ(landmarks[0].name, "door");
  EXPECT_EQ(landmarks[1].max_m, Eigen::Vector3d(2, 2, 2));
  store.remove_landmark("lobby", "door");
  EXPECT_EQ(store.list_landmarks("lobby").size(), 1U);
  EXPECT_EQ(error_of([&] { store.remove_landmark("lobby", "door"); }).code, ErrorCode::kNotFound);
  EXPECT_EQ(error_of([&] { store.list_landmarks("office"); }).code, ErrorCode::kNotFound);
  const double nan = std::nan("");
  for (const Landmark& bad : {Landmark{"flat", {0, 0, 0}, {1, 0, 1}},
                              Landmark{"turned", {0, 0, 0}, {1, -1, 1}},
                              Landmark{"nan", {nan, 0, 0}, {1, 1, 1}},
                              Landmark{"far", {0, 0, 0}, {1, 1, HUGE_VAL}},
                              Landmark{"", {0, 0, 0}, {1, 1, 1}}}) {
    EXPECT_EQ(error_of([&] { store.add_landmark("lobby", bad); }).code, ErrorCode::kInvalidArgument)
        << bad.name;
  }
}

TEST(Store, WhatIsNotThereIsNamed) {
  Store store = memory();
  EXPECT_THAT(error_of([&] { store.load("lobby"); }).message, HasSubstr("no scene 'lobby'"));
  EXPECT_EQ(error_of([&] { store.load(42); }).code, ErrorCode::kNotFound);
  EXPECT_EQ(store.find_scene("lobby"), std::nullopt);
  const std::int64_t id = store.insert(make_record("lobby"), {}).scene_id;
  EXPECT_EQ(store.find_scene("lobby"), id);
  const auto thrown = error_of([&] { store.load("lobby", 7); });
  EXPECT_EQ(thrown.code, ErrorCode::kNotFound);
  EXPECT_THAT(thrown.message, HasSubstr("no version 7"));
}

TEST(Store, EveryChangeRaisesTheGenerationForAllToSee) {
  const TempFolder folder;
  Store writer = Store::create_or_open(folder.file("x.db"));
  const Store reader = Store::open_read_only(folder.file("x.db"));
  std::uint64_t last = reader.generation();
  const auto raised = [&] { return std::exchange(last, reader.generation()) < last; };
  const auto result = writer.insert(make_record("lobby"), {});
  EXPECT_TRUE(raised());
  EXPECT_EQ(result.generation, last);
  writer.insert(make_record("lobby"), {});
  EXPECT_TRUE(raised());
  writer.rollback("lobby");
  EXPECT_TRUE(raised());
  writer.tag("lobby", "a", "b");
  EXPECT_TRUE(raised());
  writer.untag("lobby", "a");
  EXPECT_TRUE(raised());
  writer.add_landmark("lobby", {"vent", {0, 0, 0}, {1, 1, 1}});
  EXPECT_TRUE(raised());
  writer.remove_landmark("lobby", "vent");
  EXPECT_TRUE(raised());
  writer.rename("lobby", "hall");
  EXPECT_TRUE(raised());
  writer.remove("hall");
  EXPECT_TRUE(raised());
  EXPECT_FALSE(raised());
}

TEST(Store, AReadOnlyStoreRefusesEveryChange) {
  const TempFolder folder;
  Store::create_or_open(folder.file("x.db")).insert(make_record("lobby"), {});
  Store store = Store::open_read_only(folder.file("x.db"));
  const auto refused = [](const auto& job) {
    return error_of(job).code == ErrorCode::kPermissionDenied;
  };
  EXPECT_TRUE(refused([&] { store.insert(make_record("office"), {}); }));
  EXPECT_TRUE(refused([&] { store.remove("lobby"); }));
  EXPECT_TRUE(refused([&] { store.rename("lobby", "hall"); }));
  EXPECT_TRUE(refused([&] { store.rollback("lobby"); }));
  EXPECT_TRUE(refused([&] { store.tag("lobby", "a", "b"); }));
  EXPECT_TRUE(refused([&] { store.repair({}); }));
  EXPECT_TRUE(refused([&] { store.optimize({}); }));
}

TEST(Store, OptimizeKeepsTheActiveVersionAndTheOneBefore) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"));
  for (int i = 0; i < 4; ++i) store.insert(make_record("lobby", 1, {.points = 20'000}), {});
  const OptimizeReport report = store.optimize({});
  EXPECT_THAT(
      report.dropped,
      ElementsAre("scene 'lobby' version 1 was dropped", "scene 'lobby' version 2 was dropped"));
  EXPECT_LT(report.bytes_after, report.bytes_before * 2 / 3);
  EXPECT_EQ(std::filesystem::file_size(folder.file("x.db")), report.bytes_after);
  EXPECT_EQ(store.rollback("lobby"), 3);
  EXPECT_TRUE(store.check({}).ok());
}

TEST(Store, SizeTellsTheFileAndItsLog) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"));
  store.insert(make_record("lobby", 1, {.points = 20'000}), {});
  EXPECT_GT(store.size().database_bytes, 480'000U);
  EXPECT_GT(store.size().wal_bytes, 0U);
  store.remove("lobby");
  EXPECT_GT(store.size().free_bytes, 400'000U);
}

TEST(Store, SeveralTagsChangeTogetherOrNotAtAll) {
  Store store = Store::create_or_open(":memory:");
  store.insert(make_record("lobby"), {});
  store.tag("lobby", "old", "1");
  const auto generation = store.generation();
  EXPECT_THROW(store.change_tags("lobby", {{"a", "1"}, {"none", std::nullopt}}), Error);
  EXPECT_THROW(store.change_tags("lobby", {{"a", "1"}, {"b/c", "2"}}), Error);
  EXPECT_THROW(store.change_tags("attic", {{"a", "1"}}), Error);
  EXPECT_EQ(store.show("lobby").tags, (std::map<std::string, std::string>{{"old", "1"}}));
  EXPECT_EQ(store.generation(), generation);
  store.change_tags("lobby", {{"a", "1"}, {"b", "2"}, {"old", std::nullopt}});
  EXPECT_EQ(store.show("lobby").tags, (std::map<std::string, std::string>{{"a", "1"}, {"b", "2"}}));
  EXPECT_EQ(store.generation(), generation + 1);
}

TEST(Store, ACheckpointLeavesNothingInTheLog) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"));
  store.insert(make_record("lobby"), {});
  EXPECT_GT(store.size().wal_bytes, 0U);
  store.checkpoint();
  EXPECT_EQ(store.size().wal_bytes, 0U);
}

TEST(Store, TheDatabaseItselfIsNotImported) {
  const TempFolder folder;
  Store store = Store::create_or_open(folder.file("x.db"));
  for (const char* suffix : {"", "-wal", "-shm"}) {
    const auto thrown = error_of([&] { store.import_scene(folder.file("x.db") + suffix, {}); });
    EXPECT_EQ(thrown.code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(thrown.message, HasSubstr("the database itself"));
  }
}

}  // namespace
}  // namespace landmarkdb
