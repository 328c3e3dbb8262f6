#include "engine/cloud/pcd_header.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "engine/cloud/lzf.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

// Far above anything a scanner writes; they bound the work on a header made to waste it.
constexpr std::size_t kMostHeaderLines = 1000;
constexpr std::size_t kLongestHeaderLine = 65'536;
constexpr std::size_t kMostFields = 512;
constexpr std::uint64_t kMostValuesPerField = 65'536;

using Words = std::vector<std::string_view>;

// The header's lines, as written; empty where there was none.
struct Lines {
  Words fields, sizes, types, counts, width, height, viewpoint, points, data;
};

Words split(const Input& input, std::string_view rest) {
  Words words;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
    if (words.size() == kMostFields) {
      refuse(input, "PCD header: more than " + std::to_string(kMostFields) + " words on a line");
    }
    words.push_back(word);
  }
  return words;
}

// Returns where the data starts.
std::size_t collect_lines(const Input& input, Lines& lines) {
  LineReader reader(input.text());
  std::string_view line;
  while (reader.next(line)) {
    if (reader.number() > kMostHeaderLines || line.size() > kLongestHeaderLine) {
      refuse(input,
             "PCD header: line " + std::to_string(reader.number()) + " has " +
                 std::to_string(line.size()) + " characters, want at most " +
                 std::to_string(kMostHeaderLines) + " lines of " +
                 std::to_string(kLongestHeaderLine));
    }
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword.front() == '#' || keyword == "VERSION") continue;
    const Words words = split(input, rest);
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      lines.fields = words;
    } else if (keyword == "SIZE") {
      lines.sizes = words;
    } else if (keyword == "TYPE") {
      lines.types = words;
    } else if (keyword == "COUNT") {
      lines.counts = words;
    } else if (keyword == "WIDTH") {
      lines.width = words;
    } else if (keyword == "HEIGHT") {
      lines.height = words;
    } else if (keyword == "VIEWPOINT") {
      lines.viewpoint = words;
    } else if (keyword == "POINTS") {
      lines.points = words;
    } else if (keyword == "DATA") {
      lines.data = words;
      return reader.at();
    } else {
      refuse(input, "PCD header: a line starts with " + in_quotes(keyword));
    }
  }
  refuse(input, "PCD header: no DATA line (truncated file?)");
}

std::optional<std::uint64_t> single_count(const Input& input,
                                          const Words& words,
                                          std::string_view what) {
  if (words.empty()) return std::nullopt;
  const std::optional<std::uint64_t> count = parse_count(words[0]);
  if (!count || words.size() != 1) {
    refuse(
        input,
        "PCD header: " + std::string(what) + " " + in_quotes(words[0]) + ", want one whole number");
  }
  return count;
}

ScalarType field_type(const Input& input, std::string_view type, std::uint64_t size) {
  if (type == "F" && size == 4) return ScalarType::kFloat32;
  if (type == "F" && size == 8) return ScalarType::kFloat64;
  if (type == "I" || type == "U") {
    const bool is_signed = type == "I";
    if (size == 1) return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
    if (size == 2) return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
    if (size == 4) return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
    if (size == 8) return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
  }
  refuse(input,
         "PCD header: a field of type " + in_quotes(type) + " and size " + std::to_string(size) +
             ", want I or U of 1, 2, 4, 8 or F of 4, 8");
}

void check_words(const Input& input, const Words& words, std::size_t want, std::string_view what) {
  if (words.empty() || words.size() == want) return;
  refuse(input,
         "PCD header: " + std::to_string(want) + " FIELDS, but " + std::to_string(words.size()) +
             " in " + std::string(what));
}

void lay_out_fields(const Input& input, const Lines& lines, PcdHeader& header) {
  if (lines.fields.empty()) refuse(input, "PCD header: no FIELDS line");
  check_words(input, lines.sizes, lines.fields.size(), "SIZE");
  check_words(input, lines.types, lines.fields.size(), "TYPE");
  check_words(input, lines.counts, lines.fields.size(), "COUNT");
  for (std::size_t i = 0; i < lines.fields.size(); ++i) {
    PcdField field;
    field.name = lines.fields[i];
    const std::string_view size = lines.sizes.empty() ? "4" : lines.sizes[i];
    const std::string_view type = lines.types.empty() ? "F" : lines.types[i];
    const std::string_view count = lines.counts.empty() ? "1" : lines.counts[i];
    field.type = field_type(input, type, parse_count(size).value_or(0));
    const std::optional<std::uint64_t> values = parse_count(count);
    if (!values || *values > kMostValuesPerField) {
      refuse(input,
             "PCD header: COUNT " + in_quotes(count) + ", want at most " +
                 std::to_string(kMostValuesPerField));
    }
    field.count = static_cast<std::size_t>(*values);
    field.column = header.record_values;
    field.offset = header.record_bytes;
    header.record_values += field.count;
    header.record_bytes += field.bytes();
    header.fields.push_back(field);
  }
}

void take_size(const Input& input, const Lines& lines, PcdHeader& header) {
  const auto width = single_count(input, lines.width, "WIDTH");
  const auto height = single_count(input, lines.height, "HEIGHT");
  const auto points = single_count(input, lines.points, "POINTS");
  if (!width && !points) refuse(input, "PCD header: neither WIDTH nor POINTS");
  const std::uint64_t columns = width.value_or(points.value_or(0));
  const std::uint64_t rows = height.value_or(1);
  if (rows > 0 && columns > std::numeric_limits<std::uint64_t>::max() / rows) {
    refuse(input, "PCD header: WIDTH times HEIGHT is beyond 64 bits");
  }
  header.points = points.value_or(columns * rows);
  if (header.points != columns * rows) {
    refuse(input,
           "PCD header: WIDTH " + std::to_string(columns) + " times HEIGHT " +
               std::to_string(rows) + " is not POINTS " + std::to_string(header.points));
  }
  constexpr std::uint64_t kWidest = std::numeric_limits<std::uint32_t>::max();
  if (rows > 1 && columns > 1 && rows <= kWidest && columns <= kWidest) {
    header.width = static_cast<std::uint32_t>(columns);
    header.height = static_cast<std::uint32_t>(rows);
  }
}

std::optional<Eigen::Vector3d> take_viewpoint(const Input& input, const Words& words) {
  if (words.empty()) return std::nullopt;
  std::array<double, 7> values{};
  const bool seven = words.size() == values.size();
  for (std::size_t i = 0; seven && i < values.size(); ++i) {
    values[i] = parse_number(words[i]).value_or(std::numeric_limits<double>::quiet_NaN());
  }
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!seven || !finite) {
    refuse(input, "PCD header: VIEWPOINT wants seven numbers, tx ty tz qw qx qy qz");
  }
  // How the sensor was turned says nothing of points that are in the frame of the file.
  const Eigen::Vector3d at(values[0], values[1], values[2]);
  const Eigen::Vector3d axis(values[4], values[5], values[6]);
  return at.isZero(0.0) && axis.isZero(0.0) ? std::nullopt : std::optional(at);
}

PcdData take_data(const Input& input, const Words& words) {
  const std::string_view kind = words.size() == 1 ? words[0] : "";
  if (kind == "ascii") return PcdData::kAscii;
  if (kind == "binary") return PcdData::kBinary;
  if (kind == "binary_compressed") return PcdData::kCompressed;
  refuse(input,
         "PCD header: DATA " + in_quotes(kind) + ", want ascii, binary or binary_compressed");
}

}  // namespace

PcdHeader parse_pcd_header(const Input& input, std::uint64_t max_points) {
  Lines lines;
  PcdHeader header;
  header.body = collect_lines(input, lines);
  lay_out_fields(input, lines, header);
  take_size(input, lines, header);
  header.viewpoint = take_viewpoint(input, lines.viewpoint);
  header.data = take_data(input, lines.data);
  if (header.record_values == 0) refuse(input, "PCD header: the fields have no values");
  constexpr std::uint64_t kLeastTextBytes = 2;  // a digit and a blank
  const std::uint64_t left = input.size() - header.body;
  switch (header.data) {
    case PcdData::kAscii:
      // The last number of the file needs no blank after it.
      check_count(input,
                  header.points,
                  kLeastTextBytes * header.record_values,
                  left + 1,
                  max_points,
                  "points");
      break;
    case PcdData::kBinary:
      check_count(input, header.points, header.record_bytes, left, max_points, "points");
      break;
    case PcdData::kCompressed:  // what the bytes left could unfold to
      check_count(
          input, header.points, header.record_bytes, left * kLzfMostPerByte, max_points, "points");
      break;
  }
  return header;
}

}  // namespace landmarkdb
