#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// The version of the segment's byte form; one of another version is refused.
inline constexpr std::int64_t kSegmentFormat = 1;
inline constexpr std::size_t kMaxManifestBytes = std::size_t{1} << 20U;

// The number types an array is stored in, all little-endian.
enum class DType { kFloat32, kFloat16, kUint16 };

std::string_view dtype_name(DType dtype);  // "f32", "f16", "u16"

// One array of a segment. `bytes` is the product of `shape` and the size of a number.
struct ArrayInfo {
  std::string name;
  DType dtype = DType::kFloat32;
  std::vector<std::uint64_t> shape;
  std::uint64_t bytes = 0;
  std::string sha256;  // of the array's bytes
};

// All of a scene version but the numbers in its arrays. Its JSON text is what the segment's digest
// is taken over; as it holds each array's digest, that one digest stands for everything.
struct Manifest {
  EntryKind kind = EntryKind::kPlace;
  FeatureOptions options;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  double resolution_m = 0.0;
  bool normals_from_viewpoint = false;
  CloudCounts counts;
  std::uint64_t dropped_keypoints = 0;
  std::optional<Eigen::Vector3d> up;
  std::vector<std::string> sources;
  std::vector<std::string> warnings;
  std::vector<ArrayInfo> arrays;  // in the order their bytes follow
};

// "place" or "object"; "uniform", "structure", "iss" or "narf".
std::string_view kind_name(EntryKind kind);
std::string_view keypoint_method_name(KeypointMethod method);
std::optional<EntryKind> kind_from_name(std::string_view name);
std::optional<KeypointMethod> keypoint_method_from_name(std::string_view name);

// The product of `shape` and the size of a number; nothing past 2^62.
std::optional<std::uint64_t> array_bytes(DType dtype, const std::vector<std::uint64_t>& shape);

// JSON with sorted keys and no spaces: the same manifest gives the same bytes. Bytes that are not
// UTF-8 (a file name may be anything) become U+FFFD. Throws Error{kInvalidArgument} when longer
// than kMaxManifestBytes.
std::string manifest_to_json(const Manifest& manifest);

// Reads it back. `what` begins the message of Error{kDataLoss}; an unknown format is
// Error{kUnimplemented}. Each array's bytes agree with its shape and no name is there twice.
Manifest manifest_from_json(std::string_view json, const std::string& what);

// A list of texts as a JSON array, and back; damaged text gives an empty list.
std::string texts_to_json(const std::vector<std::string>& texts);
std::vector<std::string> texts_from_json(std::string_view json);

}  // namespace landmarkdb
