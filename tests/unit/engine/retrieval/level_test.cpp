#include "engine/retrieval/level.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/engine/retrieval/scene_shelf.hpp"

namespace landmarkdb {
namespace {

// Row i of the entry is the unit vector along axis `first_axis` + i.
Entry entry_of(EntryKind kind, double voxel_m, std::size_t rows, std::size_t first_axis) {
  auto record = std::make_shared<SceneRecord>();
  record->kind = kind;
  record->options.voxel_m = voxel_m;
  record->prepared.resolution_m = voxel_m;
  record->prepared.points = {{0, 0, 0}};
  record->prepared.normals = {{0, 0, 1}};
  record->descriptors.keypoints.resize(rows);
  record->descriptors.values.assign(rows * kShotLength, 0.0F);
  for (std::size_t i = 0; i < rows; ++i) {
    record->descriptors.values[i * kShotLength + first_axis + i] = 1.0F;
  }
  CatalogEntry stored;
  stored.record = std::move(record);
  return make_entry(std::move(stored));
}

std::vector<Entry> mixed() {
  std::vector<Entry> entries;
  entries.push_back(entry_of(EntryKind::kPlace, 0.05, 2, 10));
  entries.push_back(entry_of(EntryKind::kObject, 0.05, 4, 20));
  entries.push_back(entry_of(EntryKind::kPlace, 0.07, 3, 30));
  entries.push_back(entry_of(EntryKind::kPlace, 0.05, 0, 40));
  entries.push_back(entry_of(EntryKind::kPlace, 0.05, 3, 50));
  return entries;
}

TEST(MakeLevels, GroupsPlacesByHowTheyAreDescribedAndLeavesObjectsOut) {
  const std::vector<Entry> entries = mixed();
  const std::vector<Level> levels = make_levels(entries);
  ASSERT_EQ(levels.size(), 2U);
  EXPECT_EQ(levels[0].options.voxel_m, 0.05);
  EXPECT_EQ(levels[0].entries, (std::vector<std::size_t>{0, 3, 4}));
  EXPECT_EQ(levels[0].first_row, (std::vector<std::size_t>{0, 2, 2, 5}));
  EXPECT_EQ(levels[1].entries, (std::vector<std::size_t>{2}));
  EXPECT_EQ(levels[1].index->size(), 3U);
  EXPECT_TRUE(make_levels(Entries()).empty());
}

TEST(MakeLevels, KnowsWhoseEachRowIsAlsoBesideAnEntryWithoutRows) {
  const std::vector<Entry> entries = mixed();
  const std::vector<Level> levels = make_levels(entries);
  const std::vector<std::size_t> owners{0, 0, 2, 2, 2};
  for (std::size_t row = 0; row < owners.size(); ++row) {
    EXPECT_EQ(levels[0].entry_of_row(row), owners[row]) << row;
  }
}

TEST(MakeLevel, HoldsTheChosenEntriesAlone) {
  const std::vector<Entry> entries = mixed();
  const Level level = make_level(entries, std::vector<std::size_t>{0, 4});
  EXPECT_EQ(level.options.voxel_m, 0.05);
  EXPECT_EQ(level.entries, (std::vector<std::size_t>{0, 4}));
  EXPECT_EQ(level.first_row, (std::vector<std::size_t>{0, 2, 5}));
  EXPECT_EQ(level.index->size(), 5U);
  EXPECT_EQ(level.entry_of_row(2), 1U);
}

TEST(MakeLevel, PutsRowsOfADamagedEntryBehindAllOthers) {
  std::vector<Entry> entries;
  entries.push_back(entry_of(EntryKind::kPlace, 0.05, 40, 10));
  entries.push_back(entry_of(EntryKind::kPlace, 0.05, 3, 60));
  testing::put_on_shelf(entries[0].stored)->damaged = true;
  // As like one row as another, and like the mean of many descriptors.
  const std::vector<float> query(kShotLength, 1.0F);
  for (const std::size_t most_scanned : {100U, 1U}) {
    const Level level = make_level(entries, std::vector<std::size_t>{0, 1}, {}, most_scanned);
    std::vector<DescriptorMatch> found;
    level.index->search(query, 3, found, {});
    for (const DescriptorMatch& match : found) EXPECT_GE(match.index, 40U) << most_scanned;
  }
}

TEST(MakeLevel, FindsTheSameByAllCodesAndByLists) {
  const std::vector<Entry> entries = mixed();
  const std::vector<std::size_t> chosen{0, 4};
  const Level scanned = make_level(entries, chosen, {}, 5);
  const Level listed = make_level(entries, chosen, {}, 4);
  EXPECT_TRUE(scanned.scanned);
  ASSERT_FALSE(listed.scanned);
  EXPECT_EQ(listed.first_row, scanned.first_row);
  for (const Level* level : {&scanned, &listed}) {
    std::vector<DescriptorMatch> found;
    level->index->search(entries[4].record().descriptors.values, 1, found, {});
    ASSERT_EQ(found.size(), 3U);
    for (const DescriptorMatch& match : found) {
      EXPECT_NEAR(match.distance, 0.0F, 1e-3F) << level->scanned;
    }
  }
}

}  // namespace
}  // namespace landmarkdb
