#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>

#include "engine/base/run_context.hpp"

namespace landmarkdb::cli {

enum class ProgressStyle {
  kNone,   // --quiet
  kLines,  // a plain line every 10 s: standard error is a file or a pipe
  kBar,    // one line redrawn in place: standard error is a terminal
};

// What standard error asks for.
ProgressStyle progress_style(bool quiet);

// True when colour is welcome on standard error: a terminal that is not dumb, and no NO_COLOR in
// the environment.
bool colour_wanted();

// Draws how far a long job is, with its rate and the time left. Not thread-safe; RunContext calls
// it from one thread.
//
//   ProgressBar bar(progress_style(quiet), std::cerr);
//   context.progress = bar.callback();
class ProgressBar {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;

  // `now` is for tests.
  ProgressBar(ProgressStyle style, std::ostream& out, Now now = Clock::now);
  ~ProgressBar();  // finish()
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(const Progress& progress);
  // Valid as long as the bar is.
  std::function<void(const Progress&)> callback();
  // Takes the bar off the screen, so that the next line on standard error starts clean.
  void finish();

 private:
  void start_stage(const Progress& progress, Clock::time_point now);
  void draw_bar(const Progress& progress, Clock::time_point now);
  void print_line(const Progress& progress, Clock::time_point now);

  ProgressStyle style_;
  std::ostream& out_;
  Now now_;
  bool colour_ = false;
  std::string stage_;
  std::uint64_t stage_first_ = 0;
  Clock::time_point stage_start_;
  Clock::time_point last_output_;
  bool drawn_ = false;
};

// "47 %, 1.2 M/s, 0:42 left": what the bar and the line say about a stage that began at `first`
// units and has run for `elapsed`. What is not known is left out.
std::string progress_figures(const Progress& progress,
                             std::uint64_t first,
                             std::chrono::duration<double> elapsed);

}  // namespace landmarkdb::cli
