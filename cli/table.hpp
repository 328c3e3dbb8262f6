#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace landmarkdb::cli {

enum class Align { kLeft, kRight };

// A table for people: columns padded to their widest cell, two spaces between them, a header line,
// no trailing blanks. Cells are UTF-8; control characters in them come out as '?', so that a name
// from a database cannot steer the terminal.
class Table {
 public:
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };

  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  // As many cells as columns.
  void add(std::vector<std::string> cells);
  std::string text() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

// Text from a database, a file or a server, made safe for a terminal: control characters, and bytes
// that are no UTF-8, replaced by '?'.
std::string printable(std::string_view text);
// The same, but lines stay lines.
std::string printable_lines(std::string_view text);

// "12.3 MiB"
std::string bytes_text(std::uint64_t bytes);

// "2,798,245"
std::string count_text(std::uint64_t count);
// "1 point", "1,200 points"
std::string counted(std::size_t count, const std::string& noun);

}  // namespace landmarkdb::cli
