#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/cloud/input.hpp"

namespace landmarkdb {

// Goes through an input from front to back; of a file that was not read whole, `window_bytes` are
// in memory, or what was asked for where that is more. Not thread-safe; the input must outlive it.
class ByteWindow {
 public:
  // Starts at byte `at`, which must be among those of `input.bytes`.
  explicit ByteWindow(const Input& input, std::size_t at = 0)
      : input_(input), view_(input.bytes.subspan(at)), view_at_(at), end_(input.size()) {}

  // Where the next byte stands in the file.
  std::uint64_t at() const { return view_at_ + used_; }
  // How many bytes follow, in memory or not.
  std::uint64_t left() const { return end_ - at(); }
  const Input& input() const { return input_; }

  // What follows and is in memory: at least `want` bytes, or all there are. Valid until it is asked
  // again. Throws what InputFile::read and the input's context do, which is asked once a window.
  std::span<const std::byte> ahead(std::size_t want) {
    if (view_.size() - used_ < want && at() + view_.size() - used_ < end_) fill(want);
    return view_.subspan(used_);
  }

  // Passes over the next bytes, at most `left()`.
  void skip(std::uint64_t bytes) {
    if (bytes <= view_.size() - used_) {
      used_ += static_cast<std::size_t>(bytes);
      return;
    }
    view_at_ = at() + bytes;
    view_ = {};
    used_ = 0;
  }

 private:
  void fill(std::size_t want);

  const Input& input_;
  std::span<const std::byte> view_;  // of the input's own bytes, or of the buffer
  std::uint64_t view_at_;            // where the view starts in the file
  std::size_t used_ = 0;             // of the view, passed over
  std::uint64_t end_;                // of the file
  FileBytes buffer_;
};

// Takes the next word; empty when there is none. Valid until the window is asked again. Throws
// Error{kInvalidArgument} where a file that was not read whole has no end of a word for 16 MiB.
std::string_view take_word(ByteWindow& window);

// LineReader for a window: the same lines, each valid until the next. Throws for lines as take_word
// does for words.
class LineWindow {
 public:
  explicit LineWindow(const Input& input) : window_(input) {}

  bool next(std::string_view& line);
  std::uint64_t at() const { return window_.at(); }
  std::size_t number() const { return number_; }

 private:
  ByteWindow window_;
  std::size_t number_ = 0;
};

}  // namespace landmarkdb
