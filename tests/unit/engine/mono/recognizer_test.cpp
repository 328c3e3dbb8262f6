#include "engine/mono/recognizer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/mirror_rival.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/mono/search_tables.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using testing::make_mono_catalog;
using testing::make_mono_model;
using testing::make_mono_scene;
using testing::MonoScene;

constexpr double kDegree = std::numbers::pi / 180.0;

std::shared_ptr<const MonoCatalog> catalog() {
  static const auto made = make_mono_catalog({.seed = 1}, 12);
  return made;
}

const Recognizer& recognizer() {
  static const Recognizer made(catalog());
  return made;
}

RecognizeResult ask(const MonoScene& scene, const RecognizeOptions& options = {}) {
  return recognizer().recognize(scene.features, scene.camera, options, RunContext{});
}

bool is_right(const MonoHypothesis& h, const std::string& name, const RigidPose& truth) {
  return h.model == name &&
         rotation_angle_rad(h.T_camera_object.linear().transpose() * truth.R) < 10 * kDegree &&
         (h.T_camera_object.translation() - truth.t).norm() < 0.08;
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(Recognizer, FindsModelsAmongClutterAndNothingWrong) {
  int asked = 0, right = 0, wrong = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::size_t which = seed % catalog()->entries.size();
    const MonoModelRecord& record = *catalog()->entries[which].record;
    const MonoScene scene = make_mono_scene(&record, {.seed = seed});
    const RecognizeResult result = ask(scene);
    const bool found = !result.hypotheses.empty() &&
                       is_right(result.hypotheses[0], record.model.name, scene.truth);
    if (result.status == RecognizeStatus::kRecognized && !found) ++wrong;
    if (scene.true_features < 8) continue;
    ++asked;
    right += found ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(asked, 15);
  EXPECT_GE(right, asked * 85 / 100) << "of " << asked;
}

TEST(Recognizer, FindsNothingWhereNoKnownObjectIs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto other = make_mono_model({.seed = 5000 + seed});
    const MonoScene scene = make_mono_scene(seed % 2 == 0 ? other.get() : nullptr, {.seed = seed});
    const RecognizeResult result = ask(scene);
    EXPECT_EQ(result.status, RecognizeStatus::kNotFound) << seed;
    EXPECT_FALSE(result.reason.empty());
  }
}

TEST(Recognizer, TellsPairsThatReprojectAndACovariance) {
  const MonoModelRecord& record = *catalog()->entries[3].record;
  const MonoScene scene = make_mono_scene(&record, {.seed = 77, .features = 30, .missing = 0.1});
  const RecognizeResult result = ask(scene);
  ASSERT_EQ(result.status, RecognizeStatus::kRecognized);
  const MonoHypothesis& best = result.hypotheses[0];
  EXPECT_GE(best.pairs.size(), 8U);
  double sum = 0.0;
  for (const MonoPair& pair : best.pairs) {
    const auto uv =
        project(scene.camera, best.T_camera_object * record.model.points[pair.model].xyz);
    ASSERT_TRUE(uv);
    const double residual = (*uv - scene.features.points[pair.image].uv).norm();
    EXPECT_NEAR(residual, pair.residual_px, 1e-3);
    EXPECT_EQ(record.model.points[pair.model].type, scene.features.points[pair.image].type);
    sum += residual * residual;
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(best.pairs.size())), best.rms_px, 1e-3);
  EXPECT_GT(best.covariance.diagonal().minCoeff(), 0.0);
  const Eigen::Vector3d error = best.T_camera_object.translation() - scene.truth.t;
  EXPECT_LT(error.norm(), 5.0 * std::sqrt(best.covariance.topLeftCorner<3, 3>().trace()));
}

TEST(Recognizer, GivesTheSameAnswerTwice) {
  const MonoScene scene = make_mono_scene(catalog()->entries[5].record.get(), {.seed = 9});
  const RecognizeResult one = ask(scene), other = ask(scene);
  ASSERT_EQ(one.hypotheses.size(), other.hypotheses.size());
  for (std::size_t i = 0; i < one.hypotheses.size(); ++i) {
    EXPECT_EQ(one.hypotheses[i].T_camera_object.matrix(),
              other.hypotheses[i].T_camera_object.matrix());
    EXPECT_EQ(one.hypotheses[i].confidence, other.hypotheses[i].confidence);
  }
}

TEST(Recognizer, DoesNotDependOnTheOrderOfTheFeatures) {
  const MonoModelRecord& record = *catalog()->entries[3].record;
  const MonoScene scene = make_mono_scene(&record, {.seed = 77, .features = 40, .missing = 0.1});
  const RecognizeResult before = ask(scene);
  ASSERT_EQ(before.status, RecognizeStatus::kRecognized);
  MonoScene turned = scene;
  const std::uint32_t n = static_cast<std::uint32_t>(scene.features.points.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    turned.features.points[(7 * i + 3) % n] = scene.features.points[i];
  }
  for (auto& [a, b] : turned.features.links) {
    a = (7 * a + 3) % n;
    b = (7 * b + 3) % n;
    if (a > b) std::swap(a, b);
  }
  const RecognizeResult after = ask(turned);
  ASSERT_EQ(after.status, RecognizeStatus::kRecognized);
  EXPECT_EQ(after.hypotheses[0].model, before.hypotheses[0].model);
  EXPECT_EQ(after.hypotheses[0].pairs.size(), before.hypotheses[0].pairs.size());
  EXPECT_TRUE(
      after.hypotheses[0].T_camera_object.isApprox(before.hypotheses[0].T_camera_object, 1e-6));
}

// Of a pinhole an image of twice the size is the same image, with tolerances that grow with it.
TEST(Recognizer, FindsTheSamePoseInAScaledImage) {
  const MonoModelRecord& record = *catalog()->entries[3].record;
  MonoScene scene = make_mono_scene(&record, {.seed = 77, .features = 40, .missing = 0.1});
  const RecognizeResult before = ask(scene);
  for (ImageFeature& feature : scene.features.points) {
    feature.uv *= 2.0;
    feature.sigma_px *= 2.0;
  }
  scene.camera.width = scene.features.width = 2 * scene.features.width;
  scene.camera.height = scene.features.height = 2 * scene.features.height;
  for (double* x : {&scene.camera.fx, &scene.camera.fy, &scene.camera.cx, &scene.camera.cy})
    *x *= 2.0;
  const RecognizeResult after = ask(scene);
  ASSERT_EQ(before.status, RecognizeStatus::kRecognized);
  ASSERT_EQ(after.status, RecognizeStatus::kRecognized);
  EXPECT_EQ(after.hypotheses[0].model, before.hypotheses[0].model);
  const Eigen::Isometry3d off =
      before.hypotheses[0].T_camera_object.inverse() * after.hypotheses[0].T_camera_object;
  EXPECT_LT(rotation_angle_rad(off.linear()), 0.2 * kDegree);
  EXPECT_LT(off.translation().norm(), 2e-3);
}

TEST(Recognizer, TellsASymmetricModelOnce) {
  const std::string text =
      R"({"name": "brick", "units": "m", "points": [[0,0,0],[0.12,0,0],[0.12,0.09,0],[0,0.09,0],
      [0,0,0.06],[0.12,0,0.06],[0.12,0.09,0.06],[0,0.09,0.06]],
      "faces": [[3,2,1,0],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]})";
  auto record = std::make_shared<MonoModelRecord>(
      derive_record(parse_model(std::as_bytes(std::span(text)), "brick.json", {}).model));
  ASSERT_GE(record->model.symmetries.size(), 4U);
  auto one = std::make_shared<MonoCatalog>();
  one->entries.push_back({1, record, {}});
  const Recognizer bricks(one);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const MonoScene scene = make_mono_scene(
        record.get(), {.seed = seed, .features = 14, .noise_px = 0.3, .missing = 0.0});
    const RecognizeResult result = bricks.recognize(scene.features, scene.camera, {.top = 10}, {});
    if (result.status != RecognizeStatus::kRecognized) continue;
    ++found;
    for (std::size_t i = 1; i < result.hypotheses.size(); ++i)
      EXPECT_LT(result.hypotheses[i].confidence, 0.5) << seed;
  }
  EXPECT_GE(found, 3);
}

// Quads of most models are made only for such an image.
TEST(Recognizer, FindsModelsInAnImageWithoutLinks) {
  const Recognizer fresh(catalog());
  int asked = 0, right = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const MonoModelRecord& record = *catalog()->entries[seed % catalog()->entries.size()].record;
    const MonoScene scene =
        make_mono_scene(&record, {.seed = seed, .features = 24, .missing = 0.1, .links = false});
    const RecognizeResult result = fresh.recognize(scene.features, scene.camera, {}, {});
    if (scene.true_features < 8) continue;
    ++asked;
    right +=
        !result.hypotheses.empty() && is_right(result.hypotheses[0], record.model.name, scene.truth)
            ? 1
            : 0;
  }
  EXPECT_GE(asked, 5);
  EXPECT_GE(right, asked * 7 / 10) << "of " << asked;
}

TEST(Recognizer, LooksForTheNamedModelsOnly) {
  const MonoScene scene =
      make_mono_scene(catalog()->entries[3].record.get(), {.seed = 77, .missing = 0.1});
  const RecognizeResult right = ask(scene, {.models = {"model3"}});
  EXPECT_EQ(right.status, RecognizeStatus::kRecognized);
  const RecognizeResult other = ask(scene, {.models = {"model4"}});
  EXPECT_EQ(other.status, RecognizeStatus::kNotFound);
  EXPECT_THAT(message_of([&] { ask(scene, {.models = {"castle"}}); }), HasSubstr("\"castle\""));
}

// From far away a body's mirror image with front and back exchanged looks like the body: half of a
// large one's points, those at its rim, fall into place.
TEST(Recognizer, DoesNotTakeAMirroredModelForIt) {
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    auto mirrored = std::make_shared<MonoModelRecord>(
        *catalog()->entries[seed % catalog()->entries.size()].record);
    for (ModelFeature& point : mirrored->model.points) point.xyz.x() = -point.xyz.x();
    for (auto& face : mirrored->model.faces) std::reverse(face.begin(), face.end());
    const MonoScene scene = make_mono_scene(mirrored.get(),
                                            {.seed = seed,
                                             .features = seed % 2 == 0 ? 30U : 60U,
                                             .missing = seed % 3 == 0 ? 0.0 : 0.3,
                                             .near_m = 0.9,
                                             .far_m = 2.0});
    const RecognizeResult result = ask(scene);
    EXPECT_EQ(result.status, RecognizeStatus::kNotFound) << seed;
  }
}

TEST(MirrorPose, LooksTheSameFromFarAway) {
  const MonoModelRecord& record = *catalog()->entries[4].record;
  const SearchModel model = prepare_model(catalog()->entries[4].record);
  const SearchModel mirror = prepare_mirror(record, tables_of(record));
  const RigidPose pose{rotation_from_vector({0.4, -1.1, 0.7}), Eigen::Vector3d(3.0, -2.0, 500.0)};
  const RigidPose other = mirror_pose(model, pose);
  EXPECT_NEAR(other.R.determinant(), 1.0, 1e-12);
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const Eigen::Vector3d a = pose * model.points[i].xyz, b = other * mirror.points[i].xyz;
    // 0.1 m of depth at 500 m, half a metre off the axis at most: 1e-6 of a ray.
    EXPECT_NEAR((a.head<2>() / a.z() - b.head<2>() / b.z()).norm(), 0.0, 5e-6);
  }
}

TEST(Recognizer, SaysWhyThereIsNothing) {
  MonoScene scene = make_mono_scene(nullptr, {.seed = 1, .features = 0});
  EXPECT_THAT(ask(scene).reason, HasSubstr("0 usable feature points"));
  scene = make_mono_scene(nullptr, {.seed = 1, .features = 1});
  EXPECT_THAT(ask(scene).reason, HasSubstr("1 usable feature points"));
  const Recognizer none(std::make_shared<MonoCatalog>());
  EXPECT_THAT(none.recognize(scene.features, scene.camera, {}, {}).reason, HasSubstr("no model"));
}

TEST(Recognizer, EndsOnThousandsOfFeaturesAndSaysThatItLeftSomeOut) {
  const MonoScene scene = make_mono_scene(nullptr, {.seed = 1, .features = 2000});
  const RecognizeResult result = ask(scene);
  EXPECT_EQ(result.status, RecognizeStatus::kNotFound);
  EXPECT_THAT(result.reason, HasSubstr("limit"));
}

TEST(Recognizer, BearsDuplicatesAndFeaturesAtTheBorder) {
  const MonoModelRecord& record = *catalog()->entries[3].record;
  MonoScene scene = make_mono_scene(&record, {.seed = 77, .features = 30, .missing = 0.1});
  const std::size_t count = scene.features.points.size();
  for (std::size_t i = 0; i < count; ++i) scene.features.points.push_back(scene.features.points[i]);
  for (const double edge : {0.0, 639.0}) {
    ImageFeature feature;
    feature.uv = {edge, edge * 479.0 / 639.0};
    scene.features.points.push_back(feature);
  }
  const RecognizeResult result = ask(scene);
  ASSERT_FALSE(result.hypotheses.empty());
  EXPECT_TRUE(is_right(result.hypotheses[0], "model3", scene.truth));
  std::set<std::uint32_t> images;
  for (const MonoPair& pair : result.hypotheses[0].pairs) images.insert(pair.image);
  EXPECT_EQ(images.size(), result.hypotheses[0].pairs.size());
}

TEST(Recognizer, RefusesWhatItCannotUse) {
  MonoScene scene = make_mono_scene(nullptr, {.seed = 1});
  scene.features.points[4].uv.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of([&] { ask(scene); }), HasSubstr("feature point 4"));
  scene = make_mono_scene(nullptr, {.seed = 1});
  scene.features.links.push_back({3, 600});
  EXPECT_THAT(message_of([&] { ask(scene); }), HasSubstr("600"));
  scene = make_mono_scene(nullptr, {.seed = 1});
  scene.camera.width = 320;
  EXPECT_THAT(message_of([&] { ask(scene); }), HasSubstr("320 x 480"));
}

TEST(Recognizer, AcceptsAModelOfThreePointsAndNeverFindsItAlone) {
  auto record = std::make_shared<MonoModelRecord>();
  record->model.name = "triangle";
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0.1, 0)}) {
    record->model.points.push_back({.xyz = p});
  }
  record->model.edges = {{0, 1}, {1, 2}, {0, 2}};
  record->model.diameter_m = 0.15;
  auto one = std::make_shared<MonoCatalog>();
  one->entries.push_back({1, record, {}});
  const MonoScene scene =
      make_mono_scene(record.get(), {.seed = 2, .features = 20, .missing = 0.0});
  EXPECT_EQ(Recognizer(one).recognize(scene.features, scene.camera, {}, {}).status,
            RecognizeStatus::kNotFound);
}

TEST(Recognizer, StopsWhenAsked) {
  const MonoScene scene = make_mono_scene(nullptr, {.seed = 1, .features = 400});
  RunContext run;
  run.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_THROW(recognizer().recognize(scene.features, scene.camera, {}, run), Error);
}

// Six by six dots on a plane: a pose that is off by one row still matches thirty of them.
std::shared_ptr<const MonoModelRecord> dots() {
  auto record = std::make_shared<MonoModelRecord>();
  MonoModel& model = record->model;
  model.name = "dots";
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      const Eigen::Vector3d at(0.034 * x, 0.034 * y, 0.0);
      model.circles.push_back({at, Eigen::Vector3d::UnitZ(), 0.011});
      model.points.push_back({.type = FeatureType::kConicCentre,
                              .xyz = at,
                              .part = static_cast<std::int32_t>(model.circles.size() - 1)});
    }
  }
  model.diameter_m = 0.24;
  for (int turn = 0; turn < 4; ++turn) {
    const Eigen::Vector3d middle(0.085, 0.085, 0.0);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = rotation_from_vector({0, 0, turn * std::numbers::pi / 2});
    T.translation() = middle - T.linear() * middle;
    Eigen::Isometry3d flip = Eigen::Isometry3d::Identity();
    flip.linear() = rotation_from_vector({std::numbers::pi, 0, 0});
    flip.translation() = middle - flip.linear() * middle;
    model.symmetries.push_back(T.matrix());
    model.symmetries.push_back((T * flip).matrix());
  }
  model.symmetry_class = "d4";
  return record;
}

TEST(FindLookalikes, KnowsTheNextPlacesOfAGrid) {
  const std::vector<Eigen::Isometry3d> found = find_lookalikes(dots()->model, 0.4, 48);
  bool next = false;
  for (const Eigen::Isometry3d& T : found) {
    const Eigen::Vector3d t = T.translation();
    next =
        next || (T.linear().isIdentity(1e-6) && (t - Eigen::Vector3d(0.034, 0, 0)).norm() < 1e-6);
    EXPECT_FALSE(T.isApprox(Eigen::Isometry3d::Identity(), 1e-6));
  }
  EXPECT_TRUE(next);
  EXPECT_TRUE(find_lookalikes(catalog()->entries[0].record->model, 0.4, 48).empty());
}

TEST(Recognizer, IsNotOffByARowOnAGridOfDots) {
  const auto record = dots();
  auto one = std::make_shared<MonoCatalog>();
  one->entries.push_back({1, record, {}});
  const Recognizer grid(one);
  const SearchModel search = prepare_model(record);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const RigidPose truth{
        rotation_from_vector({random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 0.2}),
        Eigen::Vector3d(
            random.uniform(-0.1, 0.0), random.uniform(-0.1, 0.0), random.uniform(0.4, 0.7))};
    MonoScene scene = make_mono_scene(nullptr, {.seed = seed, .features = 25, .links = false});
    for (const PosePoint& point : search.points) {
      if (random.uniform() < 0.08) continue;
      const SeenRay ray = seen_ray(point, truth);
      ImageFeature feature;
      feature.type = FeatureType::kConicCentre;
      feature.uv = distort(scene.camera, ray.ray) +
                   Eigen::Vector2d(0.3 * random.normal(), 0.3 * random.normal());
      scene.features.points.push_back(feature);
    }
    const RecognizeResult result = grid.recognize(scene.features, scene.camera, {}, {});
    if (result.status != RecognizeStatus::kRecognized) continue;
    ++found;
    const Eigen::Isometry3d& T = result.hypotheses[0].T_camera_object;
    EXPECT_TRUE(
        same_but_for_symmetry(search, truth, {T.linear(), T.translation()}, 3 * kDegree, 0.01))
        << seed;
  }
  EXPECT_GE(found, 10);
}

// A square grid looks the same from behind, but for its points' names: it is told as seen from the
// side where its z runs away from the camera, whichever side the image is of.
TEST(Recognizer, TakesAFlatPatternToLieWithZAwayFromTheCamera) {
  auto record = std::make_shared<MonoModelRecord>(*dots());
  std::vector<Eigen::Matrix4d> turns;  // without those that show the back
  for (const Eigen::Matrix4d& S : record->model.symmetries)
    if (S(2, 2) > 0.0) turns.push_back(S);
  record->model.symmetries = turns;
  record->model.symmetry_class = "c4";
  auto one = std::make_shared<MonoCatalog>();
  one->entries.push_back({1, record, {}});
  const Recognizer grid(one);
  const SearchModel search = prepare_model(record);
  for (const double side : {0.0, std::numbers::pi}) {
    RigidPose truth;
    truth.R = rotation_from_vector({0.4, 0.3, 0.1}) * rotation_from_vector({side, 0, 0});
    truth.t = Eigen::Vector3d(0, 0, 0.5) - truth.R * search.center;
    MonoScene scene = make_mono_scene(nullptr, {.seed = 5, .features = 10, .links = false});
    for (const PosePoint& point : search.points) {
      ImageFeature feature;
      feature.type = FeatureType::kConicCentre;
      feature.uv = distort(scene.camera, seen_ray(point, truth).ray);
      scene.features.points.push_back(feature);
    }
    const RecognizeResult result = grid.recognize(scene.features, scene.camera, {}, {});
    ASSERT_EQ(result.status, RecognizeStatus::kRecognized) << side;
    EXPECT_GT(result.hypotheses[0].T_camera_object.linear()(2, 2), 0.5) << side;
  }
}

}  // namespace
}  // namespace landmarkdb
