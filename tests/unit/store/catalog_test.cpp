#include "store/catalog.hpp"

#include "store/manifest.hpp"
#include "store/sha256.hpp"
#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using testing::error_of;
using testing::make_record;
using testing::TempFolder;

Store with_two_scenes() {
  Store store = Store::create_or_open(":memory:");
  store.insert(make_record("lobby", 1), {});
  store.insert(make_record("attic", 3), {});
  return store;
}

TEST(LoadCatalog, HoldsTheActiveVersionsById) {
  Store store = with_two_scenes();
  store.insert(make_record("lobby", 5, {.points = 50}), {});
  store.tag("lobby", "floor", "1");
  store.add_landmark("lobby", {"vent", {0, 0, 0}, {1, 1, 1}});
  const auto catalog = store.load_catalog({});
  EXPECT_EQ(catalog->generation, store.generation());
  ASSERT_EQ(catalog->entries.size(), 2U);
  const CatalogEntry& lobby = catalog->entries[0];
  EXPECT_EQ(lobby.record->name, "lobby");
  EXPECT_EQ(lobby.version, 2);
  EXPECT_EQ(lobby.record->prepared.size(), 50U);
  EXPECT_EQ(lobby.tags.at("floor"), "1");
  EXPECT_EQ(lobby.landmarks.size(), 1U);
  EXPECT_LT(lobby.scene_id, catalog->entries[1].scene_id);
}

TEST(LoadCatalog, OfAnEmptyDatabaseIsEmpty) {
  EXPECT_TRUE(Store::create_or_open(":memory:").load_catalog({})->entries.empty());
}

TEST(LoadCatalog, SharesWhatThePreviousOneHolds) {
  Store store = with_two_scenes();
  const auto before = store.load_catalog({});
  store.insert(make_record("lobby", 5), {});
  store.insert(make_record("cellar", 7), {});
  const auto after = store.load_catalog({}, {}, before.get());
  ASSERT_EQ(after->entries.size(), 3U);
  EXPECT_NE(after->entries[0].record, before->entries[0].record);  // a new version
  EXPECT_EQ(after->entries[1].record, before->entries[1].record);  // unchanged
  store.rename("attic", "loft");
  EXPECT_EQ(store.load_catalog({}, {}, after.get())->entries[1].record->name, "loft");
}

TEST(LoadCatalog, CanBeStopped) {
  const Store store = with_two_scenes();
  std::stop_source source;
  RunContext context;
  context.stop = source.get_token();
  context.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.stage, "load");
    if (progress.done == 1) source.request_stop();
  };
  EXPECT_EQ(error_of([&] { store.load_catalog(context); }).code, ErrorCode::kCancelled);
}

TEST(LoadOutlines, SetsASceneAsideThatSaysMoreThanTheFileHolds) {
  const TempFolder folder;
  const std::string path = folder.file("x.db");
  Store::create_or_open(path).insert(make_record("lobby"), {});
  {
    const sqlite::Database database(path, sqlite::OpenMode::kReadWrite, std::chrono::seconds(1));
    sqlite::Statement row(database, "SELECT manifest FROM segment");
    ASSERT_TRUE(row.step());
    Manifest manifest = manifest_from_json(row.text(0), "lobby");
    for (ArrayInfo& info : manifest.arrays) {
      if (info.name != "keypoints") continue;
      info.shape[0] = std::uint64_t{1} << 40U;
      info.bytes = 12 * info.shape[0];
    }
    const std::string json = manifest_to_json(manifest);
    const std::string digest = sha256_of(json);
    sqlite::Statement update(database, "UPDATE segment SET manifest = ?, sha256 = ?");
    update.bind(json).bind(digest);
    update.run();
  }
  std::vector<DamagedScene> damaged;
  const auto catalog = Store::open_read_only(path).load_outlines(
      {}, [&](const DamagedScene& scene) { damaged.push_back(scene); });
  EXPECT_TRUE(catalog->entries.empty());
  ASSERT_EQ(damaged.size(), 1U);
  EXPECT_THAT(damaged[0].what, ::testing::HasSubstr("more bytes than the database"));
}

TEST(LoadCatalog, DoesNotTakeAnotherFilesSceneForTheOneItHolds) {
  Store first = Store::create_or_open(":memory:");
  first.insert(make_record("lobby", 1), {});
  Store second = Store::create_or_open(":memory:");
  second.insert(make_record("lobby", 3), {});
  const auto before = first.load_catalog({});
  EXPECT_EQ(before->entries[0].sha256, first.show("lobby").versions[0].sha256);
  const auto after = second.load_catalog({}, {}, before.get());
  EXPECT_NE(after->entries[0].record, before->entries[0].record);
  EXPECT_NE(after->entries[0].record->prepared.points, before->entries[0].record->prepared.points);
}

}  // namespace
}  // namespace landmarkdb
