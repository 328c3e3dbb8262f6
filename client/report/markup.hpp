#pragma once

#include <string>
#include <vector>

namespace landmarkdb::client {

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
