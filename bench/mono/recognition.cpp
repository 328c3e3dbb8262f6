#include "bench/mono/recognition.hpp"

#include <algorithm>
#include <ctime>
#include <map>
#include <memory>
#include <numbers>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/recognizer.hpp"

namespace landmarkdb::bench {
namespace {

constexpr double kRightTurn_deg = 10.0, kRightShift_mm = 80.0;
constexpr std::uint64_t kUnknownSeeds = 1'000'000;  // of models that are in no catalogue

std::shared_ptr<const MonoModelRecord> mirrored(const MonoModelRecord& record) {
  auto result = std::make_shared<MonoModelRecord>(record);
  for (ModelFeature& point : result->model.points) point.xyz.x() = -point.xyz.x();
  for (std::vector<std::uint32_t>& face : result->model.faces)
    std::reverse(face.begin(), face.end());
  return result;
}

// Of the clock, or of this thread's work: recognition runs on one.
double time_ms(bool cpu) {
  timespec now{};
  clock_gettime(cpu ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// One recogniser a catalogue: building it takes a second.
const Recognizer& recognizer_of(const RecognitionOptions& options,
                                std::shared_ptr<const MonoCatalog>& catalog) {
  struct Made {
    std::shared_ptr<const MonoCatalog> catalog;
    std::unique_ptr<Recognizer> recognizer;
  };
  static std::map<std::array<std::uint64_t, 3>, Made> made;
  Made& one = made[{options.models, options.model.seed, options.model.types}];
  if (!one.recognizer) {
    one.catalog = testing::make_mono_catalog(options.model, options.models);
    one.recognizer = std::make_unique<Recognizer>(one.catalog);
  }
  catalog = one.catalog;
  return *one.recognizer;
}

Outcome judge(const RecognizeResult& result,
              const testing::MonoScene& scene,
              const MonoModelRecord* record,
              bool edges) {
  Outcome outcome;
  outcome.true_features = scene.true_features;
  if (result.hypotheses.empty()) return outcome;
  const MonoHypothesis& best = result.hypotheses.front();
  outcome.told = true;
  outcome.accepted = result.status == RecognizeStatus::kRecognized;
  outcome.confidence = best.confidence;
  outcome.evidence = evidence_of(best, edges);
  if (record == nullptr || best.model != record->model.name) return outcome;
  outcome.turn_deg = rotation_angle_rad(best.T_camera_object.linear().transpose() * scene.truth.R) *
                     180.0 / std::numbers::pi;
  outcome.shift_mm = (best.T_camera_object.translation() - scene.truth.t).norm() * 1e3;
  outcome.right = outcome.turn_deg < kRightTurn_deg && outcome.shift_mm < kRightShift_mm;
  return outcome;
}

}  // namespace

std::vector<Outcome> run_recognition(const RecognitionOptions& options) {
  std::shared_ptr<const MonoCatalog> catalog;
  const Recognizer& recognizer = recognizer_of(options, catalog);
  std::vector<Outcome> outcomes;
  for (std::size_t i = 0; i < options.scenes; ++i) {
    testing::MonoSceneOptions of_scene = options.scene;
    of_scene.seed = options.seed * 1'000'003 + i;
    of_scene.types = options.model.types;
    Random random(of_scene.seed);
    const MonoModelRecord& drawn = *catalog->entries[random.below(catalog->entries.size())].record;
    std::shared_ptr<const MonoModelRecord> other;
    const MonoModelRecord* shown = &drawn;
    if (options.kind == SceneKind::kUnknown) {
      testing::MonoModelOptions unknown = options.model;
      unknown.seed = kUnknownSeeds + of_scene.seed;
      other = testing::make_mono_model(unknown);
      shown = other.get();
    } else if (options.kind == SceneKind::kMirrored) {
      other = mirrored(drawn);
      shown = other.get();
    } else if (options.kind == SceneKind::kClutter) {
      shown = nullptr;
    }
    const testing::MonoScene scene = testing::make_mono_scene(shown, of_scene);
    const double start_ms = time_ms(options.cpu_time);
    const RecognizeResult result =
        recognizer.recognize(scene.features, scene.camera, RecognizeOptions{}, RunContext{});
    const double took_ms = time_ms(options.cpu_time) - start_ms;
    Outcome outcome =
        judge(result, scene, options.kind == SceneKind::kKnown ? &drawn : nullptr, of_scene.edges);
    outcome.kind = options.kind;
    outcome.ms = took_ms;
    outcomes.push_back(outcome);
  }
  return outcomes;
}

}  // namespace landmarkdb::bench
