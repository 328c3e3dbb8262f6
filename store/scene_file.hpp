#pragma once

#include <string>

#include "engine/base/run_context.hpp"
#include "store/scene_changes.hpp"
#include "store/segment.hpp"

namespace landmarkdb {

// One scene as a portable file. All numbers little-endian:
//
//   8 bytes   "LMDKSCN" and a line feed
//   u32       version of this layout, 1
//   u32       h, the length of the header
//   u32       m, the length of the manifest
//   h bytes   header: JSON {"landmarks": [{"max_m": [3], "min_m": [3], "name"}], "name",
//             "segment_sha256", "tags": {key: value}}
//   64 bytes  SHA-256 of all bytes so far, in hexadecimal
//   m bytes   the segment's manifest, JSON, whose SHA-256 the header names
//   ...       the arrays, one after the other in the manifest's order; nothing follows
struct SceneFile {
  std::string name;
  SceneExtras extras;
  Segment segment;
};

// `path` is made or written over. Reports the stage "export" in bytes.
void write_scene_file(const std::string& path, const SceneFile& file, const RunContext& context);

// Every length is checked against the file's size before memory is taken, every digest against its
// bytes, and the segment is decoded once. Throws Error{kInvalidArgument} naming the file for
// anything that write_scene_file did not write; Error{kUnimplemented} for a newer layout. Reports
// the stage "import" in bytes.
SceneFile read_scene_file(const std::string& path, const RunContext& context);

}  // namespace landmarkdb
