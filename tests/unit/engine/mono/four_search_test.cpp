#include "engine/mono/four_search.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

using testing::make_mono_scene;
using testing::MonoScene;

constexpr double kTenDegrees = 10.0 * std::numbers::pi / 180.0;

const MonoCatalog& catalog() {
  static const auto made = testing::make_mono_catalog({.seed = 1}, 12);
  return *made;
}

const std::vector<SearchModel>& models() {
  static const std::vector<SearchModel> made = [] {
    std::vector<SearchModel> result;
    for (const MonoCatalogEntry& entry : catalog().entries)
      result.push_back(prepare_model(entry.record));
    return result;
  }();
  return made;
}

struct Search {
  explicit Search(const MonoScene& of)
      : scene(of),
        image(scene.features, scene.camera, 8.0),
        edges(scene.features),
        check(models(), image, edges, scene.camera, {}),
        pool(models(), check) {}

  bool run(const std::vector<char>& wanted, const RunContext& context = {}) {
    static const FourIndex index(models());
    const FourSearchOptions options{0.05, 20.0, wanted};
    return search_by_fours(
        models(), index, image, linked_fours(image, 20000).fours, options, context, pool);
  }
  bool found(std::uint32_t model) {
    for (const MonoCandidate& candidate : pool.candidates()) {
      if (candidate.model == model &&
          rotation_angle_rad(candidate.pose.R.transpose() * scene.truth.R) < kTenDegrees &&
          (candidate.pose.t - scene.truth.t).norm() < 0.08) {
        return true;
      }
    }
    return false;
  }

  MonoScene scene;
  ImageView image;
  EdgeGrid edges;
  PoseCheck check;
  CandidatePool pool;
};

TEST(SearchByFours, FindsModelsOfWhichSixFeaturesAreLeftAmongClutter) {
  const std::vector<char> all(models().size(), 1);
  int few = 0, few_found = 0, many = 0, many_found = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const std::uint32_t which = static_cast<std::uint32_t>(seed % models().size());
    Search search(make_mono_scene(catalog().entries[which].record.get(), {.seed = seed}));
    if (search.scene.true_features < 6) continue;
    search.run(all);
    const bool is_few = search.scene.true_features < 8;
    (is_few ? few : many) += 1;
    (is_few ? few_found : many_found) += search.found(which) ? 1 : 0;
  }
  ASSERT_GE(few, 15);
  ASSERT_GE(many, 50);
  EXPECT_GE(few_found * 100, few * 70) << few_found << " of " << few;
  EXPECT_GE(many_found * 100, many * 95) << many_found << " of " << many;
}

TEST(SearchByFours, LooksForWantedModelsOnly) {
  Search search(make_mono_scene(catalog().entries[3].record.get(), {.seed = 77, .missing = 0.1}));
  std::vector<char> others(models().size(), 1);
  others[3] = 0;
  search.run(others);
  for (const MonoCandidate& candidate : search.pool.candidates()) EXPECT_NE(candidate.model, 3U);
}

TEST(SearchByFours, FindsTheSameTwice) {
  const MonoScene scene = make_mono_scene(catalog().entries[5].record.get(), {.seed = 9});
  const std::vector<char> all(models().size(), 1);
  Search one(scene), other(scene);
  EXPECT_EQ(one.run(all), other.run(all));
  ASSERT_EQ(one.pool.candidates().size(), other.pool.candidates().size());
  for (std::size_t i = 0; i < one.pool.candidates().size(); ++i) {
    EXPECT_EQ(one.pool.candidates()[i].pose.R, other.pool.candidates()[i].pose.R);
    EXPECT_EQ(one.pool.candidates()[i].log10_nfa, other.pool.candidates()[i].log10_nfa);
  }
}

TEST(SearchByFours, FindsNothingWithoutLinks) {
  Search search(make_mono_scene(catalog().entries[2].record.get(), {.seed = 4, .links = false}));
  EXPECT_TRUE(search.run(std::vector<char>(models().size(), 1)));
  EXPECT_TRUE(search.pool.candidates().empty());
}

TEST(PoseCheck, CountsThePointsNearFeaturesAtTheTruePoseAndNoneElsewhere) {
  Search search(make_mono_scene(catalog().entries[3].record.get(), {.seed = 77, .missing = 0.1}));
  EXPECT_GE(search.check.count_near(3, search.scene.truth), search.scene.true_features - 2);
  RigidPose behind = search.scene.truth;
  behind.t = -behind.t;
  EXPECT_EQ(search.check.count_near(3, behind), 0U);
  RigidPose outside = search.scene.truth;
  outside.t.x() += 5.0;
  EXPECT_EQ(search.check.count_near(3, outside), 0U);
}

}  // namespace
}  // namespace landmarkdb
