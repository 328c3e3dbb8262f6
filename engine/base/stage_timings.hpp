#pragma once

#include <chrono>

namespace landmarkdb {

// Wall time of each stage of a query; the names are those of the answer's `timing_ms`.
struct StageTimings {
  using Duration = std::chrono::duration<double, std::milli>;
  Duration load{}, preprocess{}, keypoints{}, describe{}, match{}, filter{}, pose{}, icp{},
      verify{}, total{};
};

// Adds the time from construction to destruction to `into`.
class StageTimer {
 public:
  explicit StageTimer(StageTimings::Duration& into)
      : into_(into), start_(std::chrono::steady_clock::now()) {}
  ~StageTimer() { into_ += std::chrono::steady_clock::now() - start_; }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimings::Duration& into_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace landmarkdb
