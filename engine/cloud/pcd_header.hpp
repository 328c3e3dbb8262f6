#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/input.hpp"
#include "engine/cloud/scalar.hpp"

namespace landmarkdb {

enum class PcdData { kAscii, kBinary, kCompressed };

struct PcdField {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::size_t count = 1;   // values a point
  std::size_t column = 0;  // of its first value, among the values of a point
  std::size_t offset = 0;  // of its first byte, among the bytes of a point
  std::size_t bytes() const { return count * scalar_size(type); }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::uint32_t width = 0, height = 0;  // 0 x 0 unless the cloud is organised
  // Where VIEWPOINT says that the points were taken from, in their frame and unit; nothing where it
  // is the identity, which nearly every PCD file has, or is not there.
  std::optional<Eigen::Vector3d> viewpoint;
  PcdData data = PcdData::kAscii;
  std::size_t body = 0;          // where the data starts
  std::size_t record_bytes = 0;  // of a point
  std::size_t record_values = 0;
};

// Reads the header of a PCD file of any version (0.5: COLUMNS, no VIEWPOINT) and checks that what
// it promises fits into the rest of the file. Throws Error{kInvalidArgument}.
PcdHeader parse_pcd_header(const Input& input, std::uint64_t max_points);

}  // namespace landmarkdb
