#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

namespace landmarkdb {

// The number types of PLY and PCD files.
enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};

constexpr std::size_t scalar_size(ScalarType type) {
  switch (type) {
    case ScalarType::kInt8:
    case ScalarType::kUint8:
      return 1;
    case ScalarType::kInt16:
    case ScalarType::kUint16:
      return 2;
    case ScalarType::kInt32:
    case ScalarType::kUint32:
    case ScalarType::kFloat32:
      return 4;
    case ScalarType::kInt64:
    case ScalarType::kUint64:
    case ScalarType::kFloat64:
      return 8;
  }
  return 0;
}

// The scalar at `at` (any alignment), little-endian or big-endian, as double.
double load_scalar(const std::byte* at, ScalarType type, bool big_endian);

// The number a piece of text spells, "nan" and "inf" included; nullopt for anything else. Does not
// depend on the locale.
std::optional<double> parse_number(std::string_view text);

// A count as text spells it: digits only. nullopt for a sign, a fraction, or more than 64 bits.
std::optional<std::uint64_t> parse_count(std::string_view text);

// Rounds to float; what float cannot hold becomes infinite.
inline float to_float(double value) {
  if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
    return value > 0 ? std::numeric_limits<float>::infinity()
                     : -std::numeric_limits<float>::infinity();
  }
  return static_cast<float>(value);
}

}  // namespace landmarkdb
