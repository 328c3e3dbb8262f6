#include "store/scene_index.hpp"

#include "store/store.hpp"
#include "tests/unit/store/store_support.hpp"

namespace landmarkdb {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_record;
using ::testing::SizeIs;

SceneIndexBlob index_of(const SceneRecord& record, const RunContext&) {
  const std::size_t numbers = record.descriptors.values.size() + record.prepared.size();
  return {3, "a maker", {std::byte{7}, static_cast<std::byte>(numbers % 251)}, {std::byte{8}}};
}
const SceneDeriver kDeriver{index_of, {3, "a maker", {}, {}}};

class SceneIndexTest : public ::testing::Test {
 protected:
  SceneIndexTest() : store(Store::create_or_open(folder.file("x.db"))) {
    store.insert(make_record("lobby"), {}, kDeriver);
    store.insert(make_record("attic", 2), {});
  }
  void execute(const std::string& sql) {
    sqlite::Database(store_path(), sqlite::OpenMode::kReadWrite, std::chrono::seconds(1))
        .execute(sql);
  }
  std::string store_path() const { return folder.file("x.db"); }
  std::optional<SceneIndexBlob> index_of_scene(std::size_t i, bool with_tails = true) const {
    return store.load_outlines({})->entries.at(i).source->index(with_tails, {});
  }

  testing::TempFolder folder;
  Store store;
};

TEST_F(SceneIndexTest, IsStoredWithTheVersionAndReadOnDemand) {
  const auto index = index_of_scene(0);
  ASSERT_TRUE(index);
  EXPECT_TRUE(index->is_made_like(kDeriver.index_format));
  EXPECT_THAT(index->codes, SizeIs(2));
  EXPECT_THAT(index->tails, SizeIs(1));
  EXPECT_EQ(index_of_scene(0, false)->codes, index->codes);
  EXPECT_THAT(index_of_scene(0, false)->tails, IsEmpty());
  EXPECT_FALSE(index_of_scene(1));
  EXPECT_TRUE(store.check({}).ok());
}

TEST_F(SceneIndexTest, ADamagedOneIsNotReadAndMadeAnew) {
  for (const char* sql : {"UPDATE scene_index SET codes = x'0102'",
                          "UPDATE scene_index SET tails = x'01'",
                          "UPDATE scene_index SET version = 4",
                          "UPDATE scene_index SET params = 'another'",
                          "UPDATE scene_index SET segment_id = 2 WHERE segment_id = 1"}) {
    execute(sql);
    EXPECT_FALSE(index_of_scene(0)) << sql;
    EXPECT_FALSE(index_of_scene(1)) << sql;
    EXPECT_THAT(store.check({}).findings, ElementsAre(HasSubstr("search index is damaged")));
    store.repair({}, {}, kDeriver);
    EXPECT_TRUE(index_of_scene(0)) << sql;
    EXPECT_TRUE(store.check({}).ok());
    execute("DELETE FROM scene_index WHERE segment_id = 2");
  }
  execute("UPDATE scene_index SET codes = x'0102'");
  EXPECT_THAT(store.repair({}).repaired, Each(HasSubstr("search index was dropped")));
  EXPECT_THAT(store.optimize({}, {}, kDeriver).renewed, SizeIs(2));
  EXPECT_THAT(store.optimize({}, {}, kDeriver).renewed, IsEmpty());
}

TEST_F(SceneIndexTest, DamagedTailsHarmNobodyWhoDoesNotReadThem) {
  execute("UPDATE scene_index SET tails = x'01'");
  EXPECT_TRUE(index_of_scene(0, false));
  EXPECT_FALSE(index_of_scene(0, true));
}

TEST_F(SceneIndexTest, GoesWithItsScene) {
  store.remove("lobby");
  EXPECT_FALSE(index_of_scene(0));
  EXPECT_TRUE(store.check({}).ok());
}

TEST_F(SceneIndexTest, OutlinesReadTheRestAndTellWhenItIsGone) {
  const auto outlines = store.load_outlines({});
  const auto whole = store.load_catalog({});
  ASSERT_EQ(outlines->entries.size(), 2U);
  const CatalogEntry& entry = outlines->entries[0];
  EXPECT_THAT(entry.record->prepared.points, IsEmpty());
  EXPECT_EQ(entry.record->name, "lobby");
  EXPECT_EQ(entry.points, whole->entries[0].record->prepared.size());
  EXPECT_EQ(entry.keypoints, whole->entries[0].record->descriptors.size());
  testing::expect_same_record(*entry.source->load(SceneParts::kWhole, {}),
                              *whole->entries[0].record);
  const auto surface = entry.source->load(SceneParts::kSurface, {});
  EXPECT_EQ(surface->prepared.points, whole->entries[0].record->prepared.points);
  EXPECT_THAT(surface->descriptors.values, IsEmpty());
  EXPECT_EQ(store.load_outlines({}, {}, outlines.get())->entries[0].record, entry.record);
  store.remove("lobby");
  EXPECT_EQ(testing::error_of([&] { entry.source->load(SceneParts::kSurface, {}); }).code,
            ErrorCode::kDataLoss);
}

}  // namespace
}  // namespace landmarkdb
