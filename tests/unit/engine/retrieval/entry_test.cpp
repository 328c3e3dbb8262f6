#include "engine/retrieval/entry.hpp"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

TEST(Spread, TakesEvenlyAndNoMoreThanThereAre) {
  EXPECT_TRUE(spread(0, 10).empty());
  EXPECT_TRUE(spread(10, 0).empty());
  EXPECT_EQ(spread(3, 10), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(spread(10, 5), (std::vector<std::uint32_t>{0, 2, 4, 6, 8}));
  for (const std::size_t size : {7U, 100U, 12'345U}) {
    for (const std::size_t count : {1U, 3U, 99U, 4000U}) {
      const std::vector<std::uint32_t> taken = spread(size, count);
      ASSERT_EQ(taken.size(), std::min(size, count));
      for (std::size_t i = 1; i < taken.size(); ++i) ASSERT_LT(taken[i - 1], taken[i]);
      ASSERT_LT(taken.back(), size);
      EXPECT_GE(taken.back() + size / taken.size() + 1, size) << "the end is left out";
    }
  }
}

TEST(MakeEntry, DerivesWhatTheSearchNeedsFromTheRecord) {
  const testing::Surface corner = testing::corner_room(0.04);
  auto record = std::make_shared<SceneRecord>();
  record->kind = EntryKind::kObject;
  record->prepared.points = corner.points;
  record->prepared.normals = corner.normals;
  record->prepared.resolution_m = 0.05;
  CatalogEntry stored;
  stored.version = 7;
  stored.record = record;
  const Entry entry = make_entry(stored);
  EXPECT_EQ(entry.stored.version, 7);
  EXPECT_EQ(&entry.record(), record.get());
  EXPECT_TRUE(entry.is_object());
  EXPECT_EQ(entry.grid.cell_m(), 0.05F);
  EXPECT_EQ(entry.grid.surfels().size(), corner.points.size());
  EXPECT_EQ(entry.sight.get(1).size(), corner.points.size());
  EXPECT_GT(entry.extent_m, 1.5);
  EXPECT_LT(entry.extent_m, 5.2);  // the corner's diagonal
  EXPECT_LT((entry.centre - Eigen::Vector3d::Constant(1.0)).norm(), 0.5);
  EXPECT_EQ(entry.test.size(), 512U);
  const Entry again = make_entry(stored);
  EXPECT_TRUE(std::ranges::equal(entry.test.points(), again.test.points()))
      << "the same for every query";
  ASSERT_NE(entry.grid.near(corner.points[0]), nullptr);
}

}  // namespace
}  // namespace landmarkdb
