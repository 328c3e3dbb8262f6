#include "engine/base/run_context.hpp"

#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {

bool RunContext::should_stop() const {
  return stop.stop_requested() || (deadline && std::chrono::steady_clock::now() >= *deadline);
}

void RunContext::check(std::string_view stage) const {
  if (stop.stop_requested()) {
    throw Error(ErrorCode::kCancelled, "stopped on request during '" + std::string(stage) + "'");
  }
  if (deadline && std::chrono::steady_clock::now() >= *deadline) {
    throw Error(ErrorCode::kDeadlineExceeded,
                "the deadline passed during '" + std::string(stage) + "'");
  }
}

void RunContext::report(std::string_view stage, std::uint64_t done, std::uint64_t total) const {
  if (progress) progress(Progress{stage, done, total});
  check(stage);
}

}  // namespace landmarkdb
