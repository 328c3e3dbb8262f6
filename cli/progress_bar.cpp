#include "cli/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string_view>
#include <utility>

#include <unistd.h>

#include "cli/table.hpp"

namespace landmarkdb::cli {
namespace {

using namespace std::chrono_literals;

constexpr auto kBarInterval = 100ms;  // ten redraws a second look smooth and cost nothing
constexpr auto kLineInterval = 10s;   // a log line now and then shows that the job lives
constexpr int kBarWidth = 30;
// Before this much has passed a rate is noise.
constexpr double kSettled_s = 0.5;
constexpr std::string_view kEraseLine = "\r\033[K";

std::string short_number(double value) {
  char text[32];
  if (value >= 1e6) {
    std::snprintf(text, sizeof text, "%.1f M", value / 1e6);
  } else if (value >= 1e3) {
    std::snprintf(text, sizeof text, "%.1f k", value / 1e3);
  } else {
    std::snprintf(text, sizeof text, "%.0f ", value);
  }
  return text;
}

std::string short_time(double seconds) {
  const double kLongest_s = 359'999.0;  // 99:59:59, past which the figure means nothing
  const auto whole = static_cast<long>(std::ceil(std::clamp(seconds, 0.0, kLongest_s)));
  char text[32];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  }
  return text;
}

std::string bar_of(double share) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * kBarWidth));
  return '[' + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(kBarWidth - full), '.') + ']';
}

}  // namespace

ProgressStyle progress_style(bool quiet) {
  if (quiet) return ProgressStyle::kNone;
  return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

bool colour_wanted() {
  const char* no_colour = std::getenv("NO_COLOR");
  if (no_colour != nullptr && no_colour[0] != '\0') return false;
  const char* terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return false;
  return ::isatty(STDERR_FILENO) != 0;
}

std::string progress_figures(const Progress& progress,
                             std::uint64_t first,
                             std::chrono::duration<double> elapsed) {
  std::string text;
  const auto append = [&text](const std::string& figure) {
    if (!text.empty()) text += ", ";
    text += figure;
  };
  const std::uint64_t done =
      progress.total > 0 ? std::min(progress.done, progress.total) : progress.done;
  if (progress.total > 0) {
    const double share = static_cast<double>(done) / static_cast<double>(progress.total);
    append(std::to_string(static_cast<int>(share * 100.0)) + " %");
  }
  if (elapsed.count() >= kSettled_s && done > first) {
    const double rate = static_cast<double>(done - first) / elapsed.count();
    append(short_number(rate) + "/s");
    if (progress.total > done) {
      append(short_time(static_cast<double>(progress.total - done) / rate) + " left");
    }
  }
  return text;
}

ProgressBar::ProgressBar(ProgressStyle style, std::ostream& out, Now now)
    : style_(style), out_(out), now_(std::move(now)), colour_(colour_wanted()) {
  last_output_ = now_();
}

ProgressBar::~ProgressBar() { finish(); }

std::function<void(const Progress&)> ProgressBar::callback() {
  return [this](const Progress& progress) { update(progress); };
}

void ProgressBar::start_stage(const Progress& progress, Clock::time_point now) {
  stage_ = printable(progress.stage);  // may come from a server
  stage_first_ = progress.done;
  stage_start_ = now;
}

void ProgressBar::update(const Progress& progress) {
  if (style_ == ProgressStyle::kNone) return;
  const Clock::time_point now = now_();
  const bool new_stage = printable(progress.stage) != stage_;
  if (new_stage) start_stage(progress, now);
  if (style_ == ProgressStyle::kLines) {
    if (now - last_output_ >= kLineInterval) print_line(progress, now);
  } else if (new_stage || now - last_output_ >= kBarInterval) {
    draw_bar(progress, now);
  }
}

void ProgressBar::print_line(const Progress& progress, Clock::time_point now) {
  const std::string figures = progress_figures(progress, stage_first_, now - stage_start_);
  out_ << stage_ << (figures.empty() ? "" : ": ") << figures << '\n' << std::flush;
  last_output_ = now;
}

void ProgressBar::draw_bar(const Progress& progress, Clock::time_point now) {
  constexpr std::string_view kGreen = "\033[32m";
  constexpr std::string_view kPlain = "\033[0m";
  constexpr std::size_t kStageWidth = 10;  // the longest stage name of ours
  std::string stage = stage_;
  stage.resize(std::max(stage.size(), kStageWidth), ' ');
  out_ << kEraseLine << stage << ' ';
  if (progress.total > 0) {
    if (colour_) out_ << kGreen;
    out_ << bar_of(static_cast<double>(progress.done) / static_cast<double>(progress.total));
    if (colour_) out_ << kPlain;
    out_ << ' ';
  }
  out_ << progress_figures(progress, stage_first_, now - stage_start_) << std::flush;
  last_output_ = now;
  drawn_ = true;
}

void ProgressBar::finish() {
  if (drawn_) out_ << kEraseLine << std::flush;
  drawn_ = false;
}

}  // namespace landmarkdb::cli
