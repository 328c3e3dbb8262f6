#include "engine/retrieval/scene_index.hpp"

#include <limits>

#include <Eigen/Geometry>
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
  for (std::size_t i = 0; i < rows; ++i) {
    record.descriptors.keypoints.push_back(record.prepared.points[i]);
    const Eigen::AngleAxisf turn(0.01F * static_cast<float>(i), Eigen::Vector3f::UnitX());
    record.descriptors.frames.push_back(turn.toRotationMatrix());
  }
  return record;
}

TEST(SceneIndex, GivesCodesAndOutlineBack) {
  for (const std::size_t rows : {std::size_t{0}, kRows}) {
    const SceneRecord record = record_of(rows);
    const DescriptorCodes codes = make_codes(record.descriptors.values, {});
    const PlaceOutline outline = make_place_outline(record);
    const std::optional<SceneIndex> read =
        scene_index_from(make_scene_index(record, {}), EntryKind::kPlace, rows, true);
    ASSERT_TRUE(read) << rows;
    EXPECT_EQ(read->codes.centres, codes.centres);
    EXPECT_EQ(read->codes.list_start, codes.list_start);
    EXPECT_EQ(read->codes.rows, codes.rows);
    EXPECT_EQ(read->codes.codes, codes.codes);
    EXPECT_EQ(read->codes.tails, codes.tails);
    EXPECT_EQ(read->outline.keypoints, record.descriptors.keypoints);
    EXPECT_EQ(read->outline.frames, outline.frames);
    EXPECT_EQ(read->outline.surface.points, outline.surface.points);
    EXPECT_EQ(read->outline.surface.normals, outline.surface.normals);
    EXPECT_GT(outline.surface.points.size(), kSurface / 20);
    EXPECT_LT(outline.surface.points.size(), kSurface / 2);
  }
}

TEST(SceneIndex, OfAnObjectHasNoOutline) {
  const SceneRecord record = record_of(kRows, EntryKind::kObject);
  const std::optional<SceneIndex> read =
      scene_index_from(make_scene_index(record, {}), EntryKind::kObject, kRows, true);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->outline.surface.points.empty());
  EXPECT_TRUE(read->outline.keypoints.empty());
  EXPECT_EQ(read->codes.size(), kRows);
}

TEST(SceneIndex, IsNothingWhenItDoesNotFit) {
  const SceneIndexBlob good = make_scene_index(record_of(kRows), {});
  EXPECT_FALSE(scene_index_from(good, EntryKind::kPlace, kRows - 1, true));
  SceneIndexBlob other = good;
  other.version = 1;
  EXPECT_FALSE(scene_index_from(other, EntryKind::kPlace, kRows, true));
  other = good;
  other.params += "!";
  EXPECT_FALSE(scene_index_from(other, EntryKind::kPlace, kRows, true));
  for (std::size_t cut = 0; cut < good.codes.size(); cut += 997) {
    other = good;
    other.codes.resize(cut);
    EXPECT_FALSE(scene_index_from(other, EntryKind::kPlace, kRows, true)) << cut;
  }
  other = good;
  other.codes.push_back({});
  EXPECT_FALSE(scene_index_from(other, EntryKind::kPlace, kRows, true));
  for (const std::size_t count : {4U, 8U, 12U}) {  // four billion lists, keypoints or points
    other = good;
    for (std::size_t i = count; i < count + 4; ++i) other.codes[i] = std::byte{255};
    EXPECT_FALSE(scene_index_from(other, EntryKind::kPlace, kRows, true));
  }
}

TEST(SceneIndex, OfAPlaceMustHaveItsKeypoints) {
  const SceneIndexBlob of_object = make_scene_index(record_of(kRows, EntryKind::kObject), {});
  EXPECT_TRUE(scene_index_from(of_object, EntryKind::kObject, kRows, true));
  EXPECT_FALSE(scene_index_from(of_object, EntryKind::kPlace, kRows, true));
  const SceneIndexBlob of_place = make_scene_index(record_of(kRows), {});
  EXPECT_FALSE(scene_index_from(of_place, EntryKind::kObject, kRows, true));
}

TEST(SceneIndex, IsNothingWithKeypointsThatAreNowhere) {
  for (const float far : {std::numeric_limits<float>::quiet_NaN(), 1e30F}) {
    SceneRecord record = record_of(kRows);
    record.descriptors.keypoints[7].y() = far;
    const SceneIndexBlob blob = make_scene_index(record, {});
    EXPECT_FALSE(scene_index_from(blob, EntryKind::kPlace, kRows, true)) << far;
  }
}

TEST(SceneIndex, NeedsTailsOnlyWhereTheyAreWanted) {
  SceneIndexBlob blob = make_scene_index(record_of(kRows), {});
  blob.tails.push_back({});
  EXPECT_FALSE(scene_index_from(blob, EntryKind::kPlace, kRows, true));
  blob.tails.resize(blob.tails.size() - 2);
  EXPECT_FALSE(scene_index_from(blob, EntryKind::kPlace, kRows, true));
  blob.tails.clear();
  EXPECT_FALSE(scene_index_from(blob, EntryKind::kPlace, kRows, true));
  const std::optional<SceneIndex> read = scene_index_from(blob, EntryKind::kPlace, kRows, false);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->codes.tails.empty());
}

TEST(SceneIndex, IsNothingWithANumberThatIsNone) {
  SceneIndexBlob blob = make_scene_index(record_of(kRows), {});
  for (std::size_t i = blob.codes.size() - 4; i < blob.codes.size(); ++i) {
    blob.codes[i] = std::byte{255};
  }
  EXPECT_FALSE(scene_index_from(blob, EntryKind::kPlace, kRows, true));
}

}  // namespace
}  // namespace landmarkdb
