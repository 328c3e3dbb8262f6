#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/types/scene_record.hpp"
#include "store/manifest.hpp"

namespace landmarkdb {

// One scene version in its byte form: immutable, checksummed, the same wherever it lies (rows of a
// database, an export file, another store). schema/README.md describes each array.
struct Segment {
  Manifest manifest;
  std::string manifest_json;                   // the bytes the digest is taken over
  std::string sha256;                          // of manifest_json
  std::vector<std::vector<std::byte>> arrays;  // as manifest.arrays lists them

  std::uint64_t bytes() const;  // of all arrays
};

// Throws Error{code} beginning with `what` unless the record's arrays fit together and all numbers
// are finite: what a Localizer may rely on.
void validate_record(const SceneRecord& record, const std::string& what, ErrorCode code);

// The segment of a record, without its name (which can change). The same record gives the same
// bytes. Descriptors are rounded to 16-bit floats, local reference frames become unit quaternions.
// Throws Error{kInvalidArgument} for a record that validate_record refuses or that holds
// descriptor values past the range of 16-bit floats.
Segment encode_segment(const SceneRecord& record);

// The record of a segment whose digests have been checked; `segment` is consumed. Descriptor rows
// are brought back to unit length; without them where only the surface is wanted. Throws
// Error{kDataLoss} beginning with `what`.
SceneRecord decode_segment(Segment segment,
                           std::string name,
                           const std::string& what,
                           SceneParts parts = SceneParts::kWhole);

// What the manifest alone says of the record. Throws like decode_segment.
SceneRecord outline_of(const Manifest& manifest, std::string name, const std::string& what);

// True for the arrays that decode_segment needs for these parts, and for all it does not know.
bool is_part(std::string_view array, SceneParts parts);

// Throws Error{kDataLoss} when `bytes` are not the array that `info` describes.
void verify_array(const ArrayInfo& info, std::span<const std::byte> bytes, const std::string& what);

}  // namespace landmarkdb
