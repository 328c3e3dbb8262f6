#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/mono/recognize_confidence.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb::bench {

// What is in a generated image.
enum class SceneKind { kKnown, kUnknown, kMirrored, kClutter };

struct RecognitionOptions {
  std::size_t models = 100;
  std::size_t scenes = 300;
  std::uint64_t seed = 1;
  SceneKind kind = SceneKind::kKnown;
  bool cpu_time = false;  // times are of the thread, not of the clock: for a busy machine
  testing::MonoModelOptions model{};
  testing::MonoSceneOptions scene{};
};

// One image's outcome. Right: the model, within 10 degrees and 80 mm.
struct Outcome {
  SceneKind kind = SceneKind::kKnown;
  std::size_t true_features = 0;
  bool told = false;  // there is a hypothesis, accepted or not
  bool right = false;
  bool accepted = false;
  double ms = 0.0;
  double turn_deg = 0.0, shift_mm = 0.0;  // of a right one
  double confidence = 0.0;
  RecognitionEvidence evidence{};
};

std::vector<Outcome> run_recognition(const RecognitionOptions& options);

}  // namespace landmarkdb::bench
