#include "engine/mono/corner_search.hpp"

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/mono/edge_outline.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/pose_check.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

using testing::make_mono_model;
using testing::make_mono_scene;
using testing::MonoScene;
using testing::MonoSceneOptions;

constexpr double kReach_px = 8.0;

// A body of corners alone, seen with its edges; segments where two of its corners were found.
struct Picture {
  explicit Picture(std::uint64_t seed) {
    MonoModelRecord record =
        *make_mono_model({.seed = seed, .least_points = 8, .most_points = 12, .types = 1});
    record.triples = make_triples(record.model);
    model = std::make_shared<const MonoModelRecord>(std::move(record));
    models.push_back(prepare_model(model));
    MonoSceneOptions options{.seed = seed, .features = 30, .noise_px = 0.3, .types = 1};
    options.edges = true;
    options.missing = 0.2;
    scene = make_mono_scene(model.get(), options);
    for (const auto& [a, b] : scene.features.links) {
      scene.features.segments.push_back(
          {scene.features.points[a].uv, scene.features.points[b].uv, 0.3});
    }
  }

  std::shared_ptr<const MonoModelRecord> model;
  std::vector<SearchModel> models;
  MonoScene scene;
};

std::vector<MonoCandidate> found_by_corners(const Picture& picture,
                                            const std::vector<char>& wanted,
                                            const RunContext& run = {}) {
  const ImageView image(picture.scene.features, picture.scene.camera, kReach_px);
  const EdgeGrid edges(picture.scene.features);
  PoseCheck check(picture.models, image, edges, picture.scene.camera, {});
  CandidatePool pool(picture.models, check);
  const std::vector<CornerModel> corner_models{prepare_corners(picture.models[0])};
  search_by_corners(picture.models,
                    corner_models,
                    picture.scene.features,
                    picture.scene.camera,
                    edges,
                    {.wanted = wanted},
                    run,
                    pool);
  return pool.candidates();
}

TEST(SearchByCorners, FindsBodiesFromTwoEdgesThatMeet) {
  int found = 0;
  constexpr int kPictures = 20;
  for (std::uint64_t seed = 1; seed <= kPictures; ++seed) {
    const Picture picture(seed);
    for (const MonoCandidate& candidate : found_by_corners(picture, {1})) {
      if ((candidate.pose.t - picture.scene.truth.t).norm() < 0.02 &&
          (candidate.pose.R - picture.scene.truth.R).norm() < 0.1) {
        ++found;
        break;
      }
    }
  }
  EXPECT_GE(found, 16);
}

TEST(SearchByCorners, LeavesAModelAloneThatIsNotWanted) {
  EXPECT_TRUE(found_by_corners(Picture(1), {0}).empty());
}

TEST(SearchByCorners, FindsNothingWithoutEdges) {
  Picture picture(1);
  picture.scene.features.edges.clear();
  EXPECT_TRUE(found_by_corners(picture, {1}).empty());
}

TEST(SearchByCorners, StopsWhenItIsTold) {
  RunContext run;
  run.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_THROW(found_by_corners(Picture(1), {1}, run), Error);
}

TEST(EdgeOutline, LiesOnTheImagesEdgesAtTheTruePoseOnly) {
  const Picture picture(3);
  const EdgeDirections edges(picture.scene.features);
  const EdgeOutline outline(picture.models[0]);
  RigidPose pose = picture.scene.truth;
  EXPECT_GT(outline.share(pose, picture.scene.camera, edges, 0.0), 0.9);
  pose.t.x() += 0.05;
  EXPECT_LT(outline.share(pose, picture.scene.camera, edges, 0.0), 0.6);
  EXPECT_EQ(outline.share(pose, picture.scene.camera, edges, 0.9), 0.0);  // told early
  pose.t.z() = -1.0;
  EXPECT_EQ(outline.share(pose, picture.scene.camera, edges, 0.0), 0.0);
}

}  // namespace
}  // namespace landmarkdb
