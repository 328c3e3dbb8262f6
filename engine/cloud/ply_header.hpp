#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/input.hpp"
#include "engine/cloud/scalar.hpp"

namespace landmarkdb {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  std::optional<ScalarType> count_type;  // set for a list; `type` is that of its items
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_list() const;
  // The fewest bytes one record takes: a list counts as empty, a number in text as two characters.
  std::uint64_t least_bytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<Eigen::Vector3d> viewpoints;  // of "comment viewpoint x y z" lines, file units
  std::size_t body = 0;                     // where the data starts
};

// Reads the header, whose lines, elements and properties are bounded in number and length, and
// checks that what it promises fits into the rest of the file. Throws Error{kInvalidArgument}.
PlyHeader parse_ply_header(const Input& input, std::uint64_t max_points);

}  // namespace landmarkdb
