#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace landmarkdb::client {

// printf into a string; the format is always a literal, the arguments numbers.
template <typename... Args>
std::string print(const char* format, Args... args) {
  const int length = std::snprintf(nullptr, 0, format, args...);
  std::string out(static_cast<std::size_t>(length > 0 ? length : 0), '\0');
  std::snprintf(out.data(), out.size() + 1, format, args...);
  return out;
}

// A table whose cells are HTML already; columns whose title begins with '#' hold numbers.
class HtmlTable {
 public:
  explicit HtmlTable(std::vector<std::string> titles) : titles_(std::move(titles)) {}
  void add(const std::vector<std::string>& cells);
  std::string html(const std::string& caption = {}) const;

 private:
  std::vector<std::string> titles_;
  std::string rows_;
};

// A bar as long as the share, 0..1, of its cell.
std::string bar(double share);

}  // namespace landmarkdb::client
