#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// What can be said of a model without its points.
struct ModelSummary {
  std::int64_t id = 0;
  std::string name;
  std::string created;  // UTC, "2024-05-01T12:00:00Z"
  std::string source;   // the file it came from, without folders
  double unit_scale = 1.0;
  double diameter_m = 0.0;
  std::string symmetry;  // the class
  std::size_t symmetries = 0;
  std::array<std::size_t, kFeatureTypes> points_of_type{};
  std::size_t points = 0;
  std::size_t edges = 0;
  std::size_t faces = 0;
  std::size_t circles = 0;
  std::size_t triples = 0;
  std::vector<std::string> warnings;
  std::optional<std::string> damage;  // what a repair or the server found: it is not served
  std::string sha256;                 // of all but its name and what is derived
};

}  // namespace landmarkdb
