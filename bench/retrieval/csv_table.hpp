#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace landmarkdb::bench {

struct CsvRow {
  std::size_t line = 0;  // in its file, from 1
  std::vector<std::string> fields;
};

// What a benchmark printed: plain comma-separated fields without quotes, as text.
struct CsvTable {
  std::string file;
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;  // each with as many fields as there are columns

  // Index of the column, or columns.size() where there is none.
  std::size_t find(std::string_view column) const;
};

// The first line names the columns; empty lines and lines that start with '#' do not count. `file`
// is what messages call it. Throws Error{kInvalidArgument} naming file and line: no header, a
// column twice, a row of another length; Error{kResourceExhausted} past a million rows.
CsvTable read_csv(std::istream& in, const std::string& file);

// The same from a file; throws Error{kNotFound} where it cannot be read.
CsvTable read_csv_file(const std::string& path);

// A finite number and nothing else. Throws Error{kInvalidArgument} naming file, line and column.
double csv_number(const CsvTable& table, const CsvRow& row, std::size_t column);

}  // namespace landmarkdb::bench
