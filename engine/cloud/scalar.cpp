#include "engine/cloud/scalar.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace landmarkdb {
namespace {

template <typename T>
double load_as(const std::byte* at, bool big_endian) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(bytes.begin(), bytes.end());
  }
  return static_cast<double>(std::bit_cast<T>(bytes));
}

}  // namespace

double load_scalar(const std::byte* at, ScalarType type, bool big_endian) {
  switch (type) {
    case ScalarType::kInt8:
      return load_as<std::int8_t>(at, big_endian);
    case ScalarType::kUint8:
      return load_as<std::uint8_t>(at, big_endian);
    case ScalarType::kInt16:
      return load_as<std::int16_t>(at, big_endian);
    case ScalarType::kUint16:
      return load_as<std::uint16_t>(at, big_endian);
    case ScalarType::kInt32:
      return load_as<std::int32_t>(at, big_endian);
    case ScalarType::kUint32:
      return load_as<std::uint32_t>(at, big_endian);
    case ScalarType::kInt64:
      return load_as<std::int64_t>(at, big_endian);
    case ScalarType::kUint64:
      return load_as<std::uint64_t>(at, big_endian);
    case ScalarType::kFloat32:
      return load_as<float>(at, big_endian);
    case ScalarType::kFloat64:
      return load_as<double>(at, big_endian);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::optional<double> parse_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc()) return value;
  if (error != std::errc::result_out_of_range) return std::nullopt;
  // Too large or too small for double: the exponent's sign says which.
  const std::size_t exponent = text.find_first_of("eE");
  const bool tiny =
      exponent != std::string_view::npos && exponent + 1 < text.size() && text[exponent + 1] == '-';
  return tiny ? 0.0 : std::numeric_limits<double>::infinity();
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace landmarkdb
