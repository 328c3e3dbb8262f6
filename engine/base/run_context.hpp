#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>

namespace landmarkdb {

// How far a long job is: `done` of `total` units of the stage named. `total` 0: not known.
struct Progress {
  std::string_view stage;
  std::uint64_t done = 0;
  std::uint64_t total = 0;
};

// What a caller hands to a long job: when to stop, whom to tell, how many threads to use.
//
// Copied freely; the callbacks must outlive the job. `progress` is called from the calling thread
// only.
struct RunContext {
  std::stop_token stop;
  std::optional<std::chrono::steady_clock::time_point> deadline;
  std::function<void(const Progress&)> progress;
  int threads = 1;

  // Throws Error{kCancelled} after a stop request and Error{kDeadlineExceeded} past the deadline;
  // both name `stage`. Cheap enough to call every millisecond of work.
  void check(std::string_view stage) const;

  // Tells the progress callback, if there is one, and checks.
  void report(std::string_view stage, std::uint64_t done, std::uint64_t total) const;

  // True once check() would throw; for inner loops that leave early and let their caller check.
  bool should_stop() const;
};

}  // namespace landmarkdb
