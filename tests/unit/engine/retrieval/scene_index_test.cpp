#include "engine/retrieval/scene_index.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/matching/make_codes.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kRows = 150;
constexpr std::size_t kSurface = 2000;

// Points on a floor of four by four metres, and descriptors of nothing in particular.
SceneRecord record_of(std::size_t rows, EntryKind kind = EntryKind::kPlace) {
  SceneRecord record;
  record.kind = kind;
  record.prepared.resolution_m = 0.05;
  Random random(1);
  for (std::size_t i = 0; i < kSurface; ++i) {
    record.prepared.points.emplace_back(
        random.uniform(0.0, 4.0), random.uniform(0.0, 4.0), 0.01 * random.uniform());
    record.prepared.normals.push_back(Eigen::Vector3f::UnitZ());
  }
  record.descriptors.values = testing::random_descriptors(rows, 4, 1);
  record.descriptors.keypoints.resize(rows, Eigen::Vector3f::Zero());
  return record;
}

TEST(SceneIndex, GivesCodesAndOutlineBack) {
  for (const std::size_t rows : {std::size_t{0}, kRows}) {
    const SceneRecord record = record_of(rows);
    const DescriptorCodes codes = make_codes(record.descriptors.values, {});
    const PlaceOutline outline = make_place_outline(record.prepared);
    const std::optional<SceneIndex> read = scene_index_from(make_scene_index(record, {}), rows);
    ASSERT_TRUE(read) << rows;
    EXPECT_EQ(read->codes.centres, codes.centres);
    EXPECT_EQ(read->codes.list_start, codes.list_start);
    EXPECT_EQ(read->codes.rows, codes.rows);
    EXPECT_EQ(read->codes.codes, codes.codes);
    EXPECT_EQ(read->codes.tails, codes.tails);
    EXPECT_EQ(read->outline.points, outline.points);
    EXPECT_EQ(read->outline.normals, outline.normals);
    EXPECT_GT(outline.points.size(), kSurface / 20);
    EXPECT_LT(outline.points.size(), kSurface / 2);
  }
}

TEST(SceneIndex, OfAnObjectHasNoOutline) {
  const SceneRecord record = record_of(kRows, EntryKind::kObject);
  const std::optional<SceneIndex> read = scene_index_from(make_scene_index(record, {}), kRows);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->outline.points.empty());
  EXPECT_EQ(read->codes.size(), kRows);
}

TEST(SceneIndex, IsNothingWhenItDoesNotFit) {
  const SceneIndexBlob good = make_scene_index(record_of(kRows), {});
  EXPECT_FALSE(scene_index_from(good, kRows - 1));
  SceneIndexBlob other = good;
  other.version = 1;
  EXPECT_FALSE(scene_index_from(other, kRows));
  other = good;
  other.params += "!";
  EXPECT_FALSE(scene_index_from(other, kRows));
  for (std::size_t cut = 0; cut < good.codes.size(); cut += 997) {
    other = good;
    other.codes.resize(cut);
    EXPECT_FALSE(scene_index_from(other, kRows)) << cut;
  }
  other = good;
  other.codes.push_back({});
  EXPECT_FALSE(scene_index_from(other, kRows));
  for (const std::size_t count : {4U, 8U}) {  // four billion lists, or points
    other = good;
    for (std::size_t i = count; i < count + 4; ++i) other.codes[i] = std::byte{255};
    EXPECT_FALSE(scene_index_from(other, kRows));
  }
}

TEST(SceneIndex, IsNothingWithANumberThatIsNone) {
  SceneIndexBlob blob = make_scene_index(record_of(kRows), {});
  for (std::size_t i = blob.codes.size() - 4; i < blob.codes.size(); ++i) {
    blob.codes[i] = std::byte{255};
  }
  EXPECT_FALSE(scene_index_from(blob, kRows));
}

}  // namespace
}  // namespace landmarkdb
