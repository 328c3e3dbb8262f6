#include "engine/cloud/ply_header.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

// Far above anything a scanner writes; they bound the work on a header made to waste it.
constexpr std::size_t kMostHeaderLines = 10'000;
constexpr std::size_t kLongestHeaderLine = 4096;
constexpr std::size_t kMostElements = 64;
constexpr std::size_t kMostProperties = 512;
constexpr std::size_t kMostViewpoints = 65'535;
constexpr std::uint64_t kLeastTextBytes = 2;  // a digit and a blank

std::optional<ScalarType> scalar_type(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, ScalarType>, 16> kNames{{
      {"char", ScalarType::kInt8},
      {"int8", ScalarType::kInt8},
      {"uchar", ScalarType::kUint8},
      {"uint8", ScalarType::kUint8},
      {"short", ScalarType::kInt16},
      {"int16", ScalarType::kInt16},
      {"ushort", ScalarType::kUint16},
      {"uint16", ScalarType::kUint16},
      {"int", ScalarType::kInt32},
      {"int32", ScalarType::kInt32},
      {"uint", ScalarType::kUint32},
      {"uint32", ScalarType::kUint32},
      {"float", ScalarType::kFloat32},
      {"float32", ScalarType::kFloat32},
      {"double", ScalarType::kFloat64},
      {"float64", ScalarType::kFloat64},
  }};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

ScalarType need_type(const Input& input, std::string_view word) {
  const std::optional<ScalarType> type = scalar_type(word);
  if (!type) refuse(input, "PLY header: " + in_quotes(word) + " is no number type");
  return *type;
}

PlyFormat parse_format(const Input& input, std::string_view rest) {
  const std::string_view format = take_word(rest);
  const std::string_view version = take_word(rest);
  if (version != "1.0") {
    refuse(input, "PLY header: version " + in_quotes(version) + ", want \"1.0\"");
  }
  if (format == "ascii") return PlyFormat::kAscii;
  if (format == "binary_little_endian") return PlyFormat::kLittleEndian;
  if (format == "binary_big_endian") return PlyFormat::kBigEndian;
  refuse(input,
         "PLY header: format " + in_quotes(format) +
             ", want ascii, binary_little_endian or binary_big_endian");
}

PlyElement parse_element(const Input& input, std::string_view rest) {
  PlyElement element;
  element.name = take_word(rest);
  const std::string_view count = take_word(rest);
  const std::optional<std::uint64_t> number = parse_count(count);
  if (!number) {
    refuse(
        input,
        "PLY header: " + in_quotes(count) + " is no count of element " + in_quotes(element.name));
  }
  element.count = *number;
  return element;
}

PlyProperty parse_property(const Input& input, std::string_view rest) {
  PlyProperty property;
  const std::string_view first = take_word(rest);
  if (first == "list") {
    property.count_type = need_type(input, take_word(rest));
    if (*property.count_type == ScalarType::kFloat32 ||
        *property.count_type == ScalarType::kFloat64) {
      refuse(input, "PLY header: a list with a fractional count, want an integer type");
    }
    property.type = need_type(input, take_word(rest));
  } else {
    property.type = need_type(input, first);
  }
  property.name = take_word(rest);
  if (property.name.empty()) refuse(input, "PLY header: a property without a name");
  return property;
}

// "viewpoint x y z" as write_cloud puts it into a comment; other comments are let pass.
void parse_comment(std::string_view rest, PlyHeader& header) {
  if (take_word(rest) != "viewpoint" || header.viewpoints.size() == kMostViewpoints) return;
  Eigen::Vector3d viewpoint;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = parse_number(take_word(rest));
    if (!value || !std::isfinite(*value)) return;
    viewpoint[axis] = *value;
  }
  header.viewpoints.push_back(viewpoint);
}

void check_promises(const Input& input, const PlyHeader& header, std::uint64_t max_points) {
  std::uint64_t available = input.size() - header.body;
  // The last number of an ascii file needs no blank after it.
  if (header.format == PlyFormat::kAscii) ++available;
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) {
      if (element.count == 0) continue;
      refuse(input, "PLY header: element " + in_quotes(element.name) + " has no properties");
    }
    const std::uint64_t each = element.least_bytes(header.format);
    // A mesh may have several faces a vertex.
    constexpr std::uint64_t kFacesPerPoint = 8;
    constexpr std::uint64_t kMostRecords = std::uint64_t{1} << 56U;
    const bool vertices = element.name == "vertex";
    check_count(input,
                element.count,
                each,
                available,
                vertices ? max_points : kFacesPerPoint * std::min(max_points, kMostRecords),
                vertices ? "points" : "records of " + in_quotes(element.name));
    available -= element.count * each;
  }
}

}  // namespace

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& property) {
    return property.count_type.has_value();
  });
}

std::uint64_t PlyElement::least_bytes(PlyFormat format) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += format == PlyFormat::kAscii ? kLeastTextBytes
                                         : scalar_size(property.count_type.value_or(property.type));
  }
  return bytes;
}

PlyHeader parse_ply_header(const Input& input, std::uint64_t max_points) {
  PlyHeader header;
  bool has_format = false;
  LineReader lines(input.text());
  std::string_view line;
  while (lines.next(line)) {
    if (lines.number() > kMostHeaderLines || line.size() > kLongestHeaderLine) {
      refuse(input,
             "PLY header: line " + std::to_string(lines.number()) + " has " +
                 std::to_string(line.size()) + " characters, want at most " +
                 std::to_string(kMostHeaderLines) + " lines of " +
                 std::to_string(kLongestHeaderLine));
    }
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword == "end_header") {
      if (!has_format) refuse(input, "PLY header: no format line");
      header.body = lines.at();
      check_promises(input, header, max_points);
      return header;
    }
    if (keyword == "format") {
      header.format = parse_format(input, rest);
      has_format = true;
    } else if (keyword == "element") {
      if (header.elements.size() == kMostElements) {
        refuse(input, "PLY header: more than " + std::to_string(kMostElements) + " elements");
      }
      header.elements.push_back(parse_element(input, rest));
    } else if (keyword == "property") {
      if (header.elements.empty()) refuse(input, "PLY header: a property before any element");
      std::vector<PlyProperty>& properties = header.elements.back().properties;
      if (properties.size() == kMostProperties) {
        refuse(input, "PLY header: more than " + std::to_string(kMostProperties) + " properties");
      }
      properties.push_back(parse_property(input, rest));
    } else if (keyword == "comment") {
      parse_comment(rest, header);
    } else if (keyword != "ply" && keyword != "obj_info" && !keyword.empty()) {
      refuse(input,
             "PLY header: line " + std::to_string(lines.number()) + " starts with " +
                 in_quotes(keyword));
    }
  }
  refuse(input, "PLY header: no end_header line (truncated file?)");
}

}  // namespace landmarkdb
