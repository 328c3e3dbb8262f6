#include "engine/retrieval/entry_cache.hpp"

#include <thread>

#include <gmock/gmock.h>

#include "tests/unit/engine/registration/surfaces.hpp"
#include "tests/unit/engine/retrieval/scene_shelf.hpp"

namespace landmarkdb {
namespace {

using testing::SceneShelf;

CatalogEntry corner(const std::string& name) {
  const testing::Surface surface = testing::corner_room(0.1);
  auto record = std::make_shared<SceneRecord>();
  record->name = name;
  record->options.voxel_m = 0.1;
  record->prepared.points = surface.points;
  record->prepared.normals = surface.normals;
  record->prepared.resolution_m = 0.1;
  CatalogEntry entry;
  entry.record = std::move(record);
  return entry;
}

class EntryCacheTest : public ::testing::Test {
 protected:
  EntryCacheTest() {
    for (const char* name : {"a", "b", "c"}) {
      CatalogEntry entry = corner(name);
      shelves.push_back(testing::put_on_shelf(entry));
      base.push_back(std::make_shared<const Entry>(make_outline(std::move(entry))));
    }
    CatalogEntry whole = corner("whole");
    bytes_each = memory_bytes(make_entry(whole));
    base.push_back(std::make_shared<const Entry>(make_entry(std::move(whole))));
  }

  std::vector<std::shared_ptr<SceneShelf>> shelves;
  std::vector<std::shared_ptr<const Entry>> base;
  std::size_t bytes_each = 0;
};

TEST_F(EntryCacheTest, LoadsWhatIsNotThereOnceAndLetsGoOfWhatWasNotUsedForLongest) {
  EntryCache cache(base, 2 * bytes_each);
  EXPECT_EQ(cache.get(3, SceneParts::kWhole, {}), base[3]) << "it was whole from the start";
  const auto a = cache.get(0, SceneParts::kSurface, {});
  EXPECT_EQ(a->grid.surfels().size(), base[3]->grid.surfels().size());
  EXPECT_EQ(a->record().name, "a");
  EXPECT_EQ(cache.get(0, SceneParts::kSurface, {}), a);
  cache.get(1, SceneParts::kSurface, {});
  EXPECT_EQ(cache.get(0, SceneParts::kSurface, {}), a);
  cache.get(2, SceneParts::kSurface, {});  // b goes
  EXPECT_EQ(cache.loads(), 3U);
  EXPECT_EQ(cache.let_go(), 1U);
  EXPECT_LE(cache.bytes(), 2 * bytes_each);
  EXPECT_EQ(cache.get(0, SceneParts::kSurface, {}), a);
  cache.get(1, SceneParts::kSurface, {});
  EXPECT_EQ(shelves[1]->loads, 2);
  EXPECT_EQ(a->grid.surfels().size(), base[3]->grid.surfels().size()) << "its user's still";
}

TEST_F(EntryCacheTest, LoadsAgainWhenMoreOfTheSceneIsWanted) {
  EntryCache cache(base, 100 * bytes_each);
  cache.get(0, SceneParts::kSurface, {});
  const auto whole = cache.get(0, SceneParts::kWhole, {});
  EXPECT_EQ(cache.get(0, SceneParts::kSurface, {}), whole);
  EXPECT_EQ(cache.loads(), 2U);
  EXPECT_EQ(cache.let_go(), 0U);
}

TEST_F(EntryCacheTest, KeepsNothingWithoutRoom) {
  EntryCache cache(base, 0);
  EXPECT_GT(cache.get(0, SceneParts::kSurface, {})->grid.surfels().size(), 0U);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST_F(EntryCacheTest, SetsADamagedEntryAsideAndTellsItOnce) {
  std::vector<std::string> told;
  EntryCache cache(base, 100 * bytes_each, [&](const CatalogEntry& entry, const std::string& what) {
    told.push_back(entry.record->name + ": " + what);
  });
  shelves[1]->damaged = true;
  EXPECT_THROW(cache.get(1, SceneParts::kSurface, {}), Error);
  shelves[1]->damaged = false;
  EXPECT_THROW(cache.get(1, SceneParts::kSurface, {}), Error) << "it stays set aside";
  EXPECT_THAT(told, ::testing::ElementsAre("b: scene 'b' is damaged"));
  EXPECT_EQ(cache.damage(1), "scene 'b' is damaged");
  EXPECT_EQ(cache.damage(0), "");
  EXPECT_EQ(shelves[1]->loads, 1);
}

TEST_F(EntryCacheTest, LoadsOneForManyThreadsAtOnce) {
  EntryCache cache(base, 100 * bytes_each);
  std::vector<std::shared_ptr<const Entry>> got(8);
  {
    std::vector<std::jthread> threads;
    for (auto& slot : got) {
      threads.emplace_back([&] { slot = cache.get(2, SceneParts::kSurface, {}); });
    }
  }
  EXPECT_THAT(got, ::testing::Each(got[0]));
  EXPECT_EQ(shelves[2]->loads, 1);
}

}  // namespace
}  // namespace landmarkdb
