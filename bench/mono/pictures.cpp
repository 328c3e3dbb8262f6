#include "bench/mono/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "datasets/mono/render_model.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/mono/search_tables.hpp"

namespace landmarkdb::bench {
namespace {

using Profile = std::vector<Eigen::Vector2d>;

constexpr std::uint64_t kStrangers = 1'000'000'000;  // seeds of bodies that are in no catalogue
constexpr double kRightTurn_deg = 5.0, kRightShift = 0.05;

// Counter-clockwise, within a width of w and a height of h.
Profile make_profile(Random& random) {
  const double w = random.uniform(0.08, 0.2), h = random.uniform(0.06, 0.2);
  const double a = w * random.uniform(0.25, 0.75), b = h * random.uniform(0.25, 0.75);
  switch (random.below(6)) {
    case 0:
    case 1:
      return {{0, 0}, {w, 0}, {w, h}, {0, h}};  // a box
    case 2:
      return {{0, 0}, {w, 0}, {w, b}, {a, b}, {a, h}, {0, h}};  // a step
    case 3:
      return {{0, 0}, {w, 0}, {w, b}, {a, h}, {0, b}};  // a gable
    case 4:
      return {{0, 0}, {w, 0}, {a, h}, {0, h}};  // a wedge
    default:
      return {{0, 0}, {w, 0}, {w, h}, {a, h}, {a, b}, {0.4 * a, b}, {0.4 * a, h}, {0, h}};
  }
}

// The profile drawn out along z, as a model file.
MonoModel make_prism(Random& random, const std::string& name) {
  const Profile profile = make_profile(random);
  const double depth = random.uniform(0.06, 0.2);
  const std::size_t n = profile.size();
  nlohmann::json file{{"name", name}, {"units", "m"}};
  std::vector<std::size_t> low, high;
  for (std::size_t side = 0; side < 2; ++side) {
    for (const Eigen::Vector2d& p : profile)
      file["points"].push_back({p.x(), p.y(), side == 0 ? 0.0 : depth});
  }
  for (std::size_t i = 0; i < n; ++i) {
    low.push_back(n - 1 - i);
    high.push_back(n + i);
    const std::size_t next = (i + 1) % n;
    file["faces"].push_back({i, next, n + next, n + i});
  }
  file["faces"].push_back(low);
  file["faces"].push_back(high);
  const std::size_t discs = random.below(3);  // upon the side y = 0
  const double w = profile[1].x(), radius = 0.12 * std::min(w, depth);
  for (std::size_t k = 0; k < discs; ++k) {
    file["circles"].push_back(
        {{"center",
          {w * (0.25 + 0.4 * static_cast<double>(k)), 0.0, depth * random.uniform(0.3, 0.7)}},
         {"normal", {0, -1, 0}},
         {"radius", radius}});
  }
  const std::string text = file.dump();
  return parse_model(std::as_bytes(std::span(text)), name + ".json", {}).model;
}

MonoModel make_body(std::uint64_t seed, std::size_t number) {
  constexpr std::size_t kConvexEvery = 4;
  const std::string name = "body" + std::to_string(number);
  if (number % kConvexEvery == kConvexEvery - 1) {
    MonoModel model =
        testing::make_mono_model({.seed = seed, .least_points = 6, .most_points = 14, .types = 1})
            ->model;
    model.name = name;
    return model;
  }
  Random random(seed);
  return make_prism(random, name);
}

Eigen::Vector3d middle_of(const MonoModel& model) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ModelFeature& point : model.points)
    middle += point.xyz / static_cast<double>(model.points.size());
  return middle;
}

Camera make_camera(Random& random) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = random.uniform(450.0, 800.0);
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.dist[0] = random.uniform(-0.25, 0.05);
  return camera;
}

// Things are not made as their models say, nor cameras as their calibrations: up to so much.
constexpr double kModelSigma = 0.01;  // of the diameter, a corner's coordinate
constexpr double kFocalSigma = 0.005, kCentreSigma_px = 2.0, kDistortionSigma = 0.01;

void bend_model(Random& random, double much, MonoModel& model) {
  for (ModelFeature& point : model.points) {
    for (double& x : point.xyz) x += much * kModelSigma * model.diameter_m * random.normal();
  }
}

Camera bent_camera(Random& random, double much, Camera camera) {
  camera.fx *= 1.0 + much * kFocalSigma * random.normal();
  camera.fy *= 1.0 + much * kFocalSigma * random.normal();
  camera.cx += much * kCentreSigma_px * random.normal();
  camera.cy += much * kCentreSigma_px * random.normal();
  camera.dist[0] += much * kDistortionSigma * random.normal();
  return camera;
}

// Any way round, its middle at (u, v) px and `depth_m` away.
Eigen::Isometry3d place(Random& random,
                        const MonoModel& model,
                        const Camera& camera,
                        double u,
                        double v,
                        double depth_m) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  const Eigen::Vector3d at((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
  T.translation() = depth_m * at - T.linear() * middle_of(model);
  return T;
}

int number_of(const MonoCatalog& catalog, const std::string& name) {
  for (std::size_t i = 0; i < catalog.entries.size(); ++i)
    if (catalog.entries[i].record->model.name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace

std::shared_ptr<const MonoCatalog> make_picture_catalog(std::uint64_t seed, std::size_t count) {
  auto catalog = std::make_shared<MonoCatalog>();
  for (std::size_t i = 0; i < count; ++i) {
    auto record = std::make_shared<MonoModelRecord>();
    record->model = make_body(seed * 1'000'003 + i, i);
    record->triples = make_triples(record->model);
    MonoCatalogEntry entry;
    entry.model_id = static_cast<std::int64_t>(i) + 1;
    entry.record = record;
    catalog->entries.push_back(entry);
  }
  return catalog;
}

Picture make_picture(const MonoCatalog& catalog, bool known, std::uint64_t seed) {
  Random random(seed);
  Picture picture;
  picture.camera = make_camera(random);
  const std::size_t others = random.below(6), number = random.below(catalog.entries.size());
  std::vector<MonoModel> bodies;
  for (std::size_t i = 0; i <= others; ++i)
    bodies.push_back(make_body(kStrangers + seed * 16 + i, random.below(catalog.entries.size())));
  if (known) {
    picture.shown = static_cast<int>(number);
    bodies[0] = catalog.entries[number].record->model;
  }
  const double size_px = random.uniform(90.0, 280.0);
  const double depth_m = picture.camera.fx * bodies[0].diameter_m / size_px;
  std::vector<datasets::SeenModel> seen;
  for (const MonoModel& body : bodies) {
    const bool first = seen.empty();
    const double u = first ? random.uniform(180.0, 460.0) : random.uniform(20.0, 620.0);
    const double v = first ? random.uniform(140.0, 340.0) : random.uniform(20.0, 460.0);
    const double depth = first ? depth_m : depth_m * random.uniform(0.8, 1.8);
    seen.push_back({&body, place(random, body, picture.camera, u, v, depth)});
  }
  picture.T_camera_object = seen[0].T_camera_object;
  const double much = random.uniform();
  bend_model(random, much, bodies[0]);
  picture.image = datasets::render_models(seen,
                                          bent_camera(random, much, picture.camera),
                                          {.noise = random.uniform(1.0, 5.0),
                                           .clutter = static_cast<int>(random.below(31)),
                                           .texture = random.uniform(0.0, 8.0),
                                           .contrast = random.uniform(0.4, 1.0),
                                           .samples = 4,
                                           .seed = seed});
  return picture;
}

Picture make_picture(const MonoCatalog& catalog,
                     const PictureOptions& options,
                     std::size_t number) {
  return make_picture(catalog, number % 2 == 0, options.seed * 1'000'003 + options.models + number);
}

bool is_right_pose(const MonoModel& model,
                   const Eigen::Isometry3d& found,
                   const Eigen::Isometry3d& truth) {
  const Eigen::Vector3d middle = middle_of(model);
  std::vector<Eigen::Matrix4d> symmetries = model.symmetries;
  if (symmetries.empty()) symmetries.push_back(Eigen::Matrix4d::Identity());
  return std::any_of(symmetries.begin(), symmetries.end(), [&](const Eigen::Matrix4d& S) {
    const Eigen::Isometry3d same = truth * Eigen::Isometry3d(S).inverse();
    const double turn_deg =
        rotation_angle_rad(same.linear().transpose() * found.linear()) * 180.0 / std::numbers::pi;
    const double shift_m = (same * middle - found * middle).norm();
    return turn_deg < kRightTurn_deg && shift_m < kRightShift * (truth * middle).norm();
  });
}

PictureOutcomes run_pictures(const PictureOptions& options) {
  constexpr double kStep_px = 6.0;
  constexpr std::size_t kMostSamples = 1000, kTold = 10;
  const auto catalog = make_picture_catalog(options.seed, options.models);
  const Recognizer recognizer(catalog);
  std::vector<SearchModel> models;
  for (const MonoCatalogEntry& entry : catalog->entries)
    models.push_back(prepare_model(entry.record, tables_of(*entry.record, {})));
  PictureOutcomes outcomes;
  for (std::size_t i = 0; i < options.pictures; ++i) {
    const Picture picture = make_picture(*catalog, options, i);
    const RecognizeResult result =
        recognizer.recognize(picture.image, picture.camera, {.top = kTold}, {});
    Outcome outcome;
    outcome.kind = picture.shown >= 0 ? SceneKind::kKnown : SceneKind::kUnknown;
    outcome.told = !result.hypotheses.empty();
    outcome.accepted = result.status == RecognizeStatus::kRecognized;
    outcome.ms = std::chrono::duration<double, std::milli>(result.timings.total).count();
    for (const MonoHypothesis& hypothesis : result.hypotheses) {
      const int number = number_of(*catalog, hypothesis.model);
      const SearchModel& model = models[static_cast<std::size_t>(number)];
      const RigidPose pose{hypothesis.T_camera_object.linear(),
                           hypothesis.T_camera_object.translation()};
      const bool right =
          number == picture.shown &&
          is_right_pose(model.model(), hypothesis.T_camera_object, picture.T_camera_object);
      const double length_px =
          kStep_px * static_cast<double>(
                         visible_edges(model, picture.camera, pose, kStep_px, kMostSamples).size());
      const RecognitionEvidence evidence = evidence_of(hypothesis, true);
      outcomes.told.push_back(
          {i, picture.shown >= 0, right, hypothesis.confidence, length_px, evidence});
      if (&hypothesis != &result.hypotheses.front()) continue;
      outcome.right = right;
      outcome.confidence = hypothesis.confidence;
      outcome.evidence = evidence;
    }
    outcomes.best.push_back(outcome);
  }
  return outcomes;
}

}  // namespace landmarkdb::bench
