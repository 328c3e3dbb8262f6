#include "engine/retrieval/contrast.hpp"

#include <gtest/gtest.h>

#include "engine/retrieval/agreement.hpp"
#include "engine/retrieval/index_cache.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::Surface;

// A corner room and a copy of it with another box, both in the catalogue; the query is the room.
struct Compared {
  std::vector<Entry> entries;
  Entries view_of_entries;
  CleanQuery query;
  QueryView view;
  SearchResult result;
  QueryOptions options;
  RunContext context;
  StageTimings timings;
  ViewCache views{query, 1, context, timings};
  IndexCache indexes;
  std::vector<Level> levels;
  std::vector<bool> wanted{true, true};
  SearchInput input{
      query, options, view_of_entries, levels, wanted, views, indexes, timings, context};

  explicit Compared(EntryKind kind = EntryKind::kPlace, bool from_known_viewpoint = false)
      : query(clean_query(room(false))) {
    for (const bool other_box : {false, true}) {
      auto record = std::make_shared<SceneRecord>();
      Surface surface = surface_of(other_box, 1);
      if (other_box) add_annex(surface);
      record->kind = kind;
      record->prepared.points = surface.points;
      record->prepared.normals = surface.normals;
      record->prepared.resolution_m = 0.05;
      if (from_known_viewpoint) record->prepared.viewpoints = {{1.2F, 1.5F, 1.4F}};
      record->descriptors.keypoints = {{1, 1, 0}, {0, 1, 1}, {2, 0, 1}};
      CatalogEntry stored;
      stored.record = std::move(record);
      entries.push_back(make_entry(std::move(stored)));
    }
    view_of_entries = Entries(entries);
    const Surface seen = surface_of(false, 2);
    view.sample_points = seen.points;
    view.sample_normals = seen.normals;
    view.descriptors.keypoints = {{1, 1, 0}, {0, 1, 1}, {2, 0, 1}};
    for (std::size_t entry = 0; entry < 2; ++entry) {
      EntryMatches matches;
      matches.entry = entry;
      matches.view = &view;
      matches.putative = {{0, 0, 0.1F}, {0, 1, 0.1F}, {1, 1, 0.1F}, {2, 0, 0.1F}};
      result.matches.push_back(matches);
      Assessed pose;
      pose.entry = entry;
      pose.matches = entry;
      result.poses.push_back(pose);
    }
  }

  static Surface surface_of(bool other_box, std::uint64_t seed) {
    Surface surface = testing::corner_room(0.03, seed);
    Random random(seed + 10);
    const Eigen::Vector3d at =
        other_box ? Eigen::Vector3d(0.4, 2.0, 0) : Eigen::Vector3d(2.3, 2.2, 0);
    surface.add(at, {0, 0, 0.6}, {0, 0.6, 0}, 0.03, random);
    surface.add(at, {0.6, 0, 0}, {0, 0, 0.6}, 0.03, random);
    return surface;
  }
  static void add_annex(Surface& surface) {
    Random random(5);
    surface.add({3.2, 0, 0}, {3, 0, 0}, {0, 3, 0}, 0.03, random);
  }
  static PointCloud room(bool other_box) {
    PointCloud cloud;
    cloud.points = surface_of(other_box, 1).points;
    return cloud;
  }
};

TEST(ContrastPoses, CountsOnlyWhatTellsTheTwoApart) {
  Compared task;
  contrast_poses(task.input, task.result);
  const std::vector<Assessed>& poses = task.result.poses;
  ASSERT_EQ(poses[0].contrast.size(), 2U);
  EXPECT_EQ(poses[1].id, 1U);
  EXPECT_GT(poses[0].contrast[1], 0.3F) << "walls and floor fit both; the box decides";
  EXPECT_LT(poses[1].contrast[0], -0.3F);
  EXPECT_NEAR(poses[0].contrast[1], -poses[1].contrast[0], 1e-5F);
}

TEST(ContrastPoses, IsNothingBetweenEqualPoses) {
  Compared task;
  task.result.poses[1] = task.result.poses[0];
  contrast_poses(task.input, task.result);
  EXPECT_EQ(task.result.poses[0].contrast[1], 0.0F);
}

// The query sees more floor than the room has; the rival has that floor too. It speaks for the
// rival unless nobody scanned there.
TEST(ContrastPoses, LeavesOutWhatLiesWhereNobodyScanned) {
  double contrast[2];
  for (const bool known : {false, true}) {
    Compared task(EntryKind::kPlace, known);
    Surface seen = Compared::surface_of(false, 2);
    Compared::add_annex(seen);
    task.view.sample_points = seen.points;
    task.view.sample_normals = seen.normals;
    contrast_poses(task.input, task.result);
    contrast[known ? 1 : 0] = static_cast<double>(task.result.poses[0].contrast[1]);
  }
  EXPECT_LT(contrast[0], 0.0);
  EXPECT_GT(contrast[1], 0.2);
}

TEST(ContrastPoses, IsTheSameOnAnyNumberOfThreads) {
  Compared one, three;
  three.context.threads = 3;
  contrast_poses(one.input, one.result);
  contrast_poses(three.input, three.result);
  EXPECT_EQ(one.result.poses[0].contrast, three.result.poses[0].contrast);
}

TEST(ContrastPoses, LeavesObjectsWithout) {
  Compared task(EntryKind::kObject);
  contrast_poses(task.input, task.result);
  EXPECT_TRUE(task.result.poses[0].contrast.empty());
}

TEST(CountAgreeing, CountsEachKeypointOnce) {
  Compared task;
  count_agreeing(task.input, task.result);
  EXPECT_EQ(task.result.poses[0].evidence.agreeing, 2.0);
  task.result.poses[0].T_entry_sensor.translation().x() = 9.0;
  count_agreeing(task.input, task.result);
  EXPECT_EQ(task.result.poses[0].evidence.agreeing, 0.0);
}

}  // namespace
}  // namespace landmarkdb
