#include "cli/values.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <system_error>
#include <vector>

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::cli {
namespace {

constexpr std::size_t kPoseNumbers = 16;
// 16 numbers with all their digits, comments and a licence header fit easily.
constexpr std::size_t kMaxPoseFileBytes = 65'536;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// nullopt for anything but one finite number.
std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

// Exactly `out.size()` finite numbers between commas; false otherwise.
bool numbers_in(std::string_view text, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto comma = text.find(',');
    if ((comma == std::string_view::npos) != (i + 1 == out.size())) return false;
    const std::optional<double> value = number_in(trimmed(text.substr(0, comma)));
    if (!value) return false;
    out[i] = *value;
    if (comma != std::string_view::npos) text.remove_prefix(comma + 1);
  }
  return true;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() <= kLongest) return '"' + std::string(text) + '"';
  return '"' + std::string(text.substr(0, kLongest)) + "...\"";
}

// The numbers of a pose, whatever parts them. Throws on a word that is no number.
std::vector<double> pose_numbers(std::string_view text, const std::string& source) {
  constexpr std::string_view kSeparators = " \t\r\n,;[]";
  std::vector<double> numbers;
  while (!text.empty()) {
    if (text.front() == '#') {
      const auto line_end = text.find('\n');
      text.remove_prefix(line_end == std::string_view::npos ? text.size() : line_end);
    } else if (kSeparators.find(text.front()) != std::string_view::npos) {
      text.remove_prefix(1);
    } else {
      const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,;[]#"));
      const std::optional<double> value = number_in(word);
      if (!value) {
        throw Error(ErrorCode::kInvalidArgument,
                    source + ": " + in_quotes(word) + " is not a finite number, want a pose of 16");
      }
      numbers.push_back(*value);
      text.remove_prefix(word.size());
    }
  }
  return numbers;
}

}  // namespace

std::string not_negative(const std::string& text) {
  return trimmed(text).starts_with('-') ? text + " is below zero" : std::string();
}

double parse_number(std::string_view text, const std::string& option) {
  const std::optional<double> value = number_in(trimmed(text));
  if (!value) throw UsageError(option, in_quotes(text) + " is not a finite number");
  return *value;
}

double parse_positive(std::string_view text, const std::string& option) {
  const double value = parse_number(text, option);
  if (value <= 0.0) throw UsageError(option, in_quotes(text) + " is not above zero");
  return value;
}

Eigen::Vector3d parse_vector3(std::string_view text, const std::string& option) {
  Eigen::Vector3d vector;
  if (!numbers_in(text, std::span(vector.data(), 3))) {
    throw UsageError(option, in_quotes(text) + " is not three finite numbers x,y,z");
  }
  return vector;
}

Eigen::Vector3d parse_direction(std::string_view text, const std::string& option) {
  Eigen::Vector3d direction = parse_vector3(text, option);
  if (direction.stableNorm() <= 0.0) throw UsageError(option, "0,0,0 is no direction");
  return direction;
}

Box parse_box(std::string_view text, const std::string& option) {
  std::array<double, 6> numbers{};
  if (!numbers_in(text, numbers)) {
    throw UsageError(option,
                     in_quotes(text) + " is not six finite numbers xmin,ymin,zmin,xmax,ymax,zmax");
  }
  Box box{Eigen::Vector3d(numbers[0], numbers[1], numbers[2]),
          Eigen::Vector3d(numbers[3], numbers[4], numbers[5])};
  if ((box.min_m.array() >= box.max_m.array()).any()) {
    throw UsageError(option, in_quotes(text) + " is empty: each minimum must be below its maximum");
  }
  return box;
}

Eigen::Isometry3d parse_pose(std::string_view text, const std::string& source) {
  const std::vector<double> numbers = pose_numbers(text, source);
  if (numbers.size() != kPoseNumbers) {
    throw Error(ErrorCode::kInvalidArgument,
                source + ": holds " + std::to_string(numbers.size()) +
                    " numbers, want a pose of 16 (4x4, row-major)");
  }
  try {
    return from_row_major(std::span<const double, kPoseNumbers>(numbers.data(), kPoseNumbers));
  } catch (const Error& error) {
    throw Error(error.code(), source + ": " + error.what());
  }
}

Eigen::Isometry3d read_pose_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxPoseFileBytes + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad() || std::filesystem::is_directory(path)) {
    throw Error(ErrorCode::kInvalidArgument, path.string() + ": pose file cannot be read");
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxPoseFileBytes) {
    throw Error(ErrorCode::kInvalidArgument,
                path.string() + ": longer than 64 KiB, want a pose of 16 numbers");
  }
  return parse_pose(text, path.string());
}

Eigen::Isometry3d read_pose(const std::string& file_or_numbers) {
  std::error_code error;
  if (std::filesystem::exists(file_or_numbers, error)) return read_pose_file(file_or_numbers);
  if (file_or_numbers.find_first_of(", ") != std::string::npos) {
    return parse_pose(file_or_numbers, in_quotes(file_or_numbers));
  }
  return read_pose_file(file_or_numbers);
}

}  // namespace landmarkdb::cli
