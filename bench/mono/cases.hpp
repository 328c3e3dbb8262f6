#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "bench/mono/recognition.hpp"

namespace landmarkdb::bench {

struct Settings {
  std::size_t scenes = 300, models = 100;
  std::size_t pictures = 600, picture_models = 12;
  std::uint64_t seed = 10000;
  std::string json_file;
  std::string overlays;  // folder for pictures with their answers; empty: none
  bool cpu_time = false;
  std::string only;  // rows whose name has this in it
};

// A row of generated scenes.
struct Case {
  const char* name;
  SceneKind kind;
  std::size_t types;
  std::size_t features;
  double clutter;
  bool links, directions, edges;
};

inline constexpr Case kCases[] = {
    {"3 types, 60 features, links", SceneKind::kKnown, 3, 60, -1.0, true, false, false},
    {"the same, edge directions", SceneKind::kKnown, 3, 60, -1.0, true, true, false},
    {"the same, directions and edges", SceneKind::kKnown, 3, 60, -1.0, true, true, true},
    {"3 types, clutter 50 %, no links", SceneKind::kKnown, 3, 60, 0.5, false, false, false},
    {"3 types, 100 features, links", SceneKind::kKnown, 3, 100, -1.0, true, false, false},
    {"1 type, 60 features, links, directions", SceneKind::kKnown, 1, 60, -1.0, true, true, false},
    {"unknown object, 60 features, links", SceneKind::kUnknown, 3, 60, -1.0, true, false, false},
    {"unknown object, directions and edges", SceneKind::kUnknown, 3, 60, -1.0, true, true, true},
    {"mirror image of a known object", SceneKind::kMirrored, 3, 60, -1.0, true, false, false},
    {"mirror image, directions and edges", SceneKind::kMirrored, 3, 60, -1.0, true, true, true},
    {"clutter alone, 60 features, links", SceneKind::kClutter, 3, 60, -1.0, true, false, false},
    {"unknown object, 400 features, 1 type", SceneKind::kUnknown, 1, 400, -1.0, true, true, false},
};

inline RecognitionOptions options_of(const Case& one,
                                     const Settings& settings,
                                     std::uint64_t seed) {
  RecognitionOptions options;
  options.models = settings.models;
  options.scenes = settings.scenes;
  options.seed = seed;
  options.kind = one.kind;
  options.cpu_time = settings.cpu_time;
  options.model.types = one.types;
  options.scene.features = one.features;
  options.scene.clutter_share = one.clutter;
  options.scene.links = one.links;
  options.scene.directions = one.directions;
  options.scene.edges = one.edges;
  return options;
}

}  // namespace landmarkdb::bench
