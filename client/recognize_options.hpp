#pragma once

#include <cstdint>
#include <string>

#include <CLI/App.hpp>

#include "engine/types/recognition.hpp"

namespace landmarkdb::client {

// What `recognize`, and `track` at its start and after a loss, take of a recognition.
struct RecognizeLimits {
  double min_confidence = 0.5;
  std::string min_depth;
  std::string max_depth;
  std::uint64_t seed = 1;
};

void add_recognize_limits(CLI::App& command, RecognizeLimits& limits);

// Throws cli::UsageError naming the option.
void apply(const RecognizeLimits& limits, RecognizeOptions& options);

}  // namespace landmarkdb::client
