#include "client/recognize_options.hpp"

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

#include "cli/usage_error.hpp"
#include "cli/values.hpp"

namespace landmarkdb::client {

void add_recognize_limits(CLI::App& command, RecognizeLimits& limits) {
  command.add_option("--min-confidence", limits.min_confidence, "Below this nothing is recognized")
      ->type_name("C")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option("--min-depth", limits.min_depth, "Nearest the object may be, in metres [0.05]")
      ->type_name("M");
  command.add_option("--max-depth", limits.max_depth, "Furthest the object may be, in metres [20]")
      ->type_name("M");
  command
      .add_option("--seed",
                  limits.seed,
                  "Given back in the answer; nothing is drawn at random, so the same image has the "
                  "same answer with any")
      ->type_name("N")
      ->check(cli::not_negative)
      ->capture_default_str();
}

void apply(const RecognizeLimits& limits, RecognizeOptions& options) {
  options.min_confidence = limits.min_confidence;
  if (!limits.min_depth.empty()) {
    options.min_depth_m = cli::parse_positive(limits.min_depth, "--min-depth");
  }
  if (!limits.max_depth.empty()) {
    options.max_depth_m = cli::parse_positive(limits.max_depth, "--max-depth");
  }
  if (options.min_depth_m >= options.max_depth_m) {
    throw cli::UsageError("--max-depth", "want more than --min-depth");
  }
  options.seed = limits.seed;
}

}  // namespace landmarkdb::client
