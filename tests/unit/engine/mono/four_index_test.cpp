#include "engine/mono/four_index.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/make_mono_scene.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

std::vector<SearchModel> bodies(std::size_t count) {
  std::vector<SearchModel> models;
  const auto catalog = testing::make_mono_catalog({.seed = 3}, count);
  for (const MonoCatalogEntry& entry : catalog->entries)
    models.push_back(prepare_model(entry.record));
  return models;
}

TEST(FourIndex, HoldsFoursThatItsEdgesJoinInTheOrderOfTheirShape) {
  const std::vector<SearchModel> models = bodies(1);
  const SearchModel& search = models[0];
  const std::vector<ModelFour> fours = fours_of(search, 0).fours;
  ASSERT_GT(fours.size(), 100U);
  for (const ModelFour& four : fours) {
    const auto& id = four.ids;
    EXPECT_EQ(std::set<std::uint16_t>(id.begin(), id.end()).size(), 4U);
    EXPECT_TRUE(search.linked(id[0], id[1]));
    if (four.shape == FourShape::kPath) {
      EXPECT_TRUE(search.linked(id[1], id[2]) && search.linked(id[2], id[3]));
    } else {
      EXPECT_TRUE(search.linked(id[0], id[2]) && search.linked(id[0], id[3]));
    }
  }
}

TEST(FourIndex, HoldsEachPathOnceInTheDirectionOfTheSmallestSignature) {
  const std::vector<SearchModel> models = bodies(1);
  const auto type_of = [&](std::uint16_t id) { return models[0].model().points[id].type; };
  std::set<std::array<std::uint16_t, 4>> known;
  for (const ModelFour& four : fours_of(models[0], 0).fours) {
    if (four.shape != FourShape::kPath) continue;
    std::array<std::uint16_t, 4> back = four.ids;
    std::reverse(back.begin(), back.end());
    EXPECT_LE(four_signature(four.ids, type_of), four_signature(back, type_of));
    EXPECT_TRUE(known.insert(four.ids).second);
    EXPECT_FALSE(known.contains(back));
  }
}

TEST(FourIndex, GroupsFoursBySignatureAndFillsUpWithSuchThatPassNoTest) {
  const std::vector<SearchModel> models = bodies(4);
  const FourIndex index(models);
  std::size_t stored = 0, expected = 0;
  for (std::uint32_t i = 0; i < models.size(); ++i) expected += fours_of(models[i], i).fours.size();
  for (const FourShape shape : {FourShape::kPath, FourShape::kStar}) {
    for (unsigned signature = 0; signature < 256; ++signature) {
      const FourIndex::Group group = index.group(shape, static_cast<std::uint8_t>(signature));
      EXPECT_EQ(group.size % FourIndex::kLanes, 0U);
      for (std::size_t i = group.first; i < group.first + group.size; ++i) {
        if (*index.metric(0, i) == 0.0F) continue;  // filled up
        ++stored;
        const ModelFour& four = index[i];
        EXPECT_EQ(four.shape, shape);
        EXPECT_EQ(four_signature(
                      four.ids,
                      [&](std::uint16_t id) { return models[four.model].model().points[id].type; }),
                  signature);
      }
    }
  }
  EXPECT_EQ(stored, expected);
}

TEST(FourIndex, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<SearchModel> models = bodies(5);
  const FourIndex one(models, 1), three(models, 3);
  const FourIndex::Group group = one.group(FourShape::kPath, 0);
  ASSERT_EQ(group.size, three.group(FourShape::kPath, 0).size);
  for (std::size_t i = group.first; i < group.first + group.size; ++i) {
    EXPECT_EQ(one[i].ids, three[i].ids);
    EXPECT_EQ(*one.metric(3, i), *three.metric(3, i));
  }
}

TEST(FourIndex, SaysThatABoxIsOftenFlatAndABodyIsNot) {
  std::vector<SearchModel> models = bodies(1);
  models.push_back(prepare_model(testing::box_record()));
  const FourIndex index(models);
  EXPECT_FALSE(index.often_flat(0));
  EXPECT_TRUE(index.often_flat(1));
}

}  // namespace
}  // namespace landmarkdb
