#include "engine/mono/pose_check.hpp"

#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "engine/mono/candidate_pool.hpp"
#include "engine/mono/recognize_confidence.hpp"
#include "engine/mono/recognizer.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

using testing::make_mono_model;
using testing::make_mono_scene;
using testing::MonoScene;

constexpr double kDegree = std::numbers::pi / 180.0;

std::shared_ptr<const MonoModelRecord> body(std::size_t corners) {
  return make_mono_model({.seed = 7, .least_points = corners, .most_points = corners, .types = 2});
}

// A model in an image of its own with everything that a check asks for.
struct Looked {
  static constexpr std::size_t kCorners = 24;
  std::shared_ptr<const MonoModelRecord> record;
  std::vector<SearchModel> models;
  MonoScene scene;
  ImageView image;
  EdgeGrid edges;
  CheckOptions options{};
  PoseCheck check;

  explicit Looked(const MonoScene& seen, std::size_t corners = kCorners)
      : record(body(corners)),
        models{prepare_model(record)},
        scene(seen),
        image(scene.features, scene.camera, 8.0),
        edges(scene.features),
        check(models, image, edges, scene.camera, options) {}

  static MonoScene make_scene(bool edges, std::size_t corners = kCorners) {
    return make_mono_scene(body(corners).get(),
                           {.seed = 3,
                            .features = corners,
                            .noise_px = 0.3,
                            .missing = 0.0,
                            .edges = edges,
                            .types = 2});
  }

  std::optional<MonoCandidate> settled() {
    const std::span<const Match> found = check.look(0, scene.truth);
    return check.settle(0, scene.truth, std::vector<Match>(found.begin(), found.end()));
  }
};

RigidPose turned(const RigidPose& pose, const Eigen::Vector3d& center, double angle_rad) {
  const Eigen::Matrix3d R = rotation_from_vector(angle_rad * Eigen::Vector3d(0.6, 0.8, 0.0));
  return {R * pose.R, R * (pose.t - pose * center) + pose * center};
}

double off_rad(const RigidPose& a, const RigidPose& b) {
  return rotation_angle_rad(a.R.transpose() * b.R);
}

TEST(PoseCheck, EdgesWhereTheModelHasThemSpeakForIt) {
  Looked looked(Looked::make_scene(true));
  const std::optional<MonoCandidate> candidate = looked.settled();
  ASSERT_TRUE(candidate);
  EXPECT_GT(candidate->edge_share, 0.7);
  EXPECT_LT(candidate->edge_odds, -1.0);
  EXPECT_LT(candidate->rank(), candidate->log10_nfa);
}

TEST(PoseCheck, EdgesElsewhereSpeakAgainstIt) {
  MonoScene scene = Looked::make_scene(true);
  for (EdgePoint& edge : scene.features.edges) edge.uv *= 0.01F;  // all in a corner
  Looked looked(scene);
  const std::optional<MonoCandidate> candidate = looked.settled();
  ASSERT_TRUE(candidate);
  EXPECT_LT(candidate->edge_share, 0.1);
  EXPECT_GT(candidate->edge_odds, 1.0);
}

TEST(PoseCheck, TellsWhetherEdgesRunAsTheModelsDo) {
  Looked looked(Looked::make_scene(true));
  std::optional<MonoCandidate> right = looked.settled();
  ASSERT_TRUE(right);
  looked.check.judge_shape(*right);
  EXPECT_GT(right->edges.supported, 0.6);
  EXPECT_LT(right->edges.overrun, 0.2);
  MonoScene scene = Looked::make_scene(true);
  for (EdgePoint& edge : scene.features.edges) edge.uv *= 0.01F;  // all in a corner
  Looked elsewhere(scene);
  std::optional<MonoCandidate> wrong = elsewhere.settled();
  ASSERT_TRUE(wrong);
  elsewhere.check.judge_shape(*wrong);
  EXPECT_EQ(wrong->edges.supported, 0.0);
}

TEST(PoseCheck, WithoutEdgesTheyHaveNoSay) {
  Looked looked(Looked::make_scene(false));
  const std::optional<MonoCandidate> candidate = looked.settled();
  ASSERT_TRUE(candidate);
  EXPECT_EQ(candidate->edge_odds, 0.0);
  EXPECT_EQ(candidate->rank(), candidate->log10_nfa);
}

// Some 30 visible corners, a third of which the quick look wants. The pose is turned until it
// fails; what grows from there is the true one.
TEST(PoseCheck, GrowsAPoseThatIsTooFarOffForTheQuickLook) {
  constexpr std::size_t kMany = 60;
  Looked looked(Looked::make_scene(false, kMany), kMany);
  int grown = 0;
  for (int step = 2; step <= 60; ++step) {
    RigidPose pose = turned(looked.scene.truth, looked.models[0].center, 0.25 * step * kDegree);
    if (!looked.check.look(0, pose).empty() || looked.check.grow(0, pose).empty()) continue;
    ++grown;
    EXPECT_LT(off_rad(pose, looked.scene.truth), 3.0 * kDegree) << step;
  }
  EXPECT_GT(grown, 0);
}

TEST(PoseCheck, DoesNotGrowWhereNothingAgrees) {
  Looked looked(Looked::make_scene(false));
  RigidPose away = looked.scene.truth;
  away.t.x() += 100.0;
  EXPECT_TRUE(looked.check.grow(0, away).empty());
  RigidPose beyond = looked.scene.truth;
  beyond.t.z() += 1000.0;  // out of the depth range
  EXPECT_TRUE(looked.check.grow(0, beyond).empty());
}

TEST(CandidatePool, EndsTheSearchOnlyWhereEdgesAgree) {
  EXPECT_TRUE(is_beyond_doubt(kBeyondDoubtWithEdges - 0.1, kBeyondDoubtShare + 0.01));
  EXPECT_FALSE(is_beyond_doubt(kBeyondDoubtWithEdges + 0.1, 1.0));
  EXPECT_FALSE(is_beyond_doubt(kBeyondDoubtHidden + 0.1, kBeyondDoubtShare - 0.01));
  EXPECT_TRUE(is_beyond_doubt(kBeyondDoubtHidden - 0.1, kBeyondDoubtShare - 0.01));
  EXPECT_FALSE(is_beyond_doubt(-100.0, kBeyondDoubtHiddenShare - 0.01));
}

TEST(CandidatePool, KeepsThePoseOfAModelOnceAndTheBetterOne) {
  Looked looked(Looked::make_scene(false));
  CandidatePool pool(looked.models, looked.check);
  MonoCandidate poor = *looked.settled(), good = poor;
  poor.log10_nfa = -2.0;
  good.log10_nfa = -3.0;
  pool.add(poor);
  pool.add(good);
  pool.add(poor);
  ASSERT_EQ(pool.candidates().size(), 1U);
  EXPECT_EQ(pool.candidates()[0].log10_nfa, -3.0);
  MonoCandidate elsewhere = poor;
  elsewhere.pose.t.x() += 0.5;
  pool.add(elsewhere);
  EXPECT_EQ(pool.candidates().size(), 2U);
  EXPECT_FALSE(pool.beyond_doubt());
}

// One shape under two names: neither is surer than the other, and the answer says so.
TEST(Rivals, OfTwoModelsOfOneShapeNeitherIsSure) {
  const Looked looked(Looked::make_scene(false));
  auto catalog = std::make_shared<MonoCatalog>();
  for (const char* name : {"left", "right"}) {
    auto record = std::make_shared<MonoModelRecord>(*looked.record);
    record->model.name = name;
    MonoCatalogEntry entry;
    entry.model_id = static_cast<std::int64_t>(catalog->entries.size()) + 1;
    entry.record = record;
    catalog->entries.push_back(entry);
  }
  const RecognizeResult both =
      Recognizer(catalog).recognize(looked.scene.features, looked.scene.camera, {}, {});
  ASSERT_GE(both.hypotheses.size(), 2U);
  EXPECT_NE(both.hypotheses[0].model, both.hypotheses[1].model);
  EXPECT_LT(both.hypotheses[0].margin, 0.5);
  EXPECT_LT(both.hypotheses[0].confidence, 0.6);
  const RecognizeResult one = Recognizer(catalog).recognize(
      looked.scene.features, looked.scene.camera, {.models = {"left"}}, {});
  ASSERT_FALSE(one.hypotheses.empty());
  EXPECT_GT(one.hypotheses[0].confidence, 0.9);
}

TEST(RecognitionConfidence, GrowsWithWhatSpeaksForAnAnswer) {
  for (const bool has_edges : {false, true}) {
    const RecognitionEvidence fair{.log10_nfa = -3.0,
                                   .matched = 8.0,
                                   .visible = 10.0,
                                   .rms_px = 1.0,
                                   .has_edges = has_edges,
                                   .edge_share = 0.85,
                                   .margin = 2.0};
    RecognitionEvidence likely_chance = fair, contested = fair, loose = fair;
    likely_chance.log10_nfa = 0.0;
    contested.margin = 0.0;
    loose.rms_px = 2.0;
    for (const RecognitionEvidence& worse : {likely_chance, contested, loose}) {
      EXPECT_LT(recognition_confidence(worse), recognition_confidence(fair));
    }
  }
}

}  // namespace
}  // namespace landmarkdb
