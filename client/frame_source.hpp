#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "client/tracking.hpp"

namespace landmarkdb::client {

// The frames of `track`, one after the other.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Goes to the next frame; false at the end. Throws Error where the source itself fails,
  // Error{kCancelled} once stopped.
  virtual bool advance() = 0;
  // How the frame is called: its file, or what its line calls it.
  virtual const std::string& name() const = 0;
  // Throws Error{kInvalidArgument} for a frame that cannot be used; the next may be fine.
  virtual TrackInput load() = 0;
  virtual std::uint64_t total() const = 0;  // frames; 0: not known
};

// What SOURCE names: a folder (its images), a pattern with * ? [ ] (quoted from the shell), one
// image, a JSON-lines file (.json, .jsonl, .ndjson), or "-": JSON lines on standard input. Throws
// Error{kInvalidArgument} where there is nothing of the kind.
std::unique_ptr<FrameSource> open_frames(const std::string& source, std::stop_token stop);

// One line: {"points": [...], "links": [...]?} as in a points file or {"image": FILE}, and "frame"
// (a name), "time_s", "q" and "q_at_image" (rad) where there are any. `name` is the line's for
// messages, and becomes "frame" where that is given. Throws Error{kInvalidArgument}.
TrackInput parse_frame(std::string_view line, std::string& name);

// By name, but runs of digits by their value: frame2 before frame10.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace landmarkdb::client
