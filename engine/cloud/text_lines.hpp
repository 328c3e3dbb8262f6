#pragma once

#include <cstddef>
#include <string_view>

namespace landmarkdb {

// Walks text line by line; ends are "\n", "\r\n" or "\r", and are not part of the line.
class LineReader {
 public:
  explicit LineReader(std::string_view text, std::size_t at = 0) : text_(text), at_(at) {}

  // False at the end of the text.
  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    std::size_t end = at_;
    while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') ++end;
    line = text_.substr(at_, end - at_);
    if (end < text_.size() && text_[end] == '\r' && end + 1 < text_.size() &&
        text_[end + 1] == '\n') {
      ++end;
    }
    at_ = end < text_.size() ? end + 1 : end;
    ++number_;
    return true;
  }

  // Where the next line starts.
  std::size_t at() const { return at_; }
  // Number of the line last given, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t at_;
  std::size_t number_ = 0;
};

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

// Takes the next word off the front of `text`; empty when there is none.
inline std::string_view take_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

}  // namespace landmarkdb
