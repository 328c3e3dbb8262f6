#include "bench/retrieval/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

constexpr std::size_t kMaxRows = 1'000'000;  // some 200 MB of text; a bench run prints hundreds

std::string at_line(const std::string& file, std::size_t line) {
  return file + ":" + std::to_string(line) + ": ";
}

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.emplace_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

void check_header(const CsvTable& table, std::size_t line) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.find(table.columns[i]) == i) continue;
    throw Error(ErrorCode::kInvalidArgument,
                at_line(table.file, line) + "column '" + table.columns[i] +
                    "' comes twice, want each name once");
  }
}

}  // namespace

std::size_t CsvTable::find(std::string_view column) const {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) -
                                  columns.begin());
}

CsvTable read_csv(std::istream& in, const std::string& file) {
  CsvTable table;
  table.file = file;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (text.empty() || text.front() == '#') continue;
    std::vector<std::string> fields = split(text);
    if (table.columns.empty()) {
      table.columns = std::move(fields);
      check_header(table, line);
      continue;
    }
    if (fields.size() != table.columns.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  at_line(file, line) + std::to_string(fields.size()) + " fields, want " +
                      std::to_string(table.columns.size()) + " as in the header");
    }
    if (table.rows.size() == kMaxRows) {
      throw Error(ErrorCode::kResourceExhausted,
                  at_line(file, line) + "more than " + std::to_string(kMaxRows) + " rows");
    }
    table.rows.push_back({line, std::move(fields)});
  }
  if (in.bad()) throw Error(ErrorCode::kDataLoss, file + ": reading broke off");
  if (table.columns.empty()) {
    throw Error(ErrorCode::kInvalidArgument, file + ": empty, want a line that names the columns");
  }
  return table;
}

CsvTable read_csv_file(const std::string& path) {
  std::ifstream in(path);
  // A folder opens, but cannot be looked into.
  if (!in || (in.peek() == std::ifstream::traits_type::eof() && in.bad())) {
    throw Error(ErrorCode::kNotFound, path + ": cannot be read, want a CSV file");
  }
  in.clear();
  return read_csv(in, path);
}

double csv_number(const CsvTable& table, const CsvRow& row, std::size_t column) {
  const std::string& text = row.fields[column];
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    throw Error(ErrorCode::kInvalidArgument,
                at_line(table.file, row.line) + table.columns[column] + " is '" + text +
                    "', want a finite number");
  }
  return value;
}

}  // namespace landmarkdb::bench
