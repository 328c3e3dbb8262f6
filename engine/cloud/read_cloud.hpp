#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

enum class Units { kMetres, kMillimetres, kCentimetres, kInches };

// Metres in one unit.
double metres_per(Units units);

struct ReadOptions {
  Units units = Units::kMetres;  // of the file's coordinates; the cloud returned is in metres
  std::uint64_t max_points =
      200'000'000;              // checked against the header before anything is allocated
  double mesh_spacing_m = 0.0;  // distance between samples of a mesh; 0: a 300th of its diagonal
  // How much of a larger file is in memory at once; its header has to fit.
  std::size_t window_bytes = std::size_t{8} << 20U;
};

// Reads a PCD, PLY, XYZ/PTS text cloud, or an OBJ, STL or PLY mesh (sampled evenly over its
// surface); the format is recognised from the content, the extension decides only where content
// cannot.
//
// Coordinates too far from zero for float keep their precision: `origin` takes a round offset. NaN
// points are kept (see sanitise); an organised cloud stays organised. Points are in
// the frame of the file, as they stand there: a VIEWPOINT in a PCD header is where they were taken
// from and moves none. The identity, which nearly every PCD file has, is believed of organised
// clouds only. PLY has viewpoints where
// write_cloud put them. A mesh's samples have normals when its vertices have, or when it is closed.
//
// Throws Error{kInvalidArgument} that names the file, what was seen and what was wanted:
// unreadable, truncated, a header that promises more than the file holds, an unknown format, no
// points; Error{kResourceExhausted} without the memory. Reports the stages "read" in bytes of the
// file and, of a mesh, "sample" in triangles, and throws what `context.check` does, within a
// fraction of a second.
PointCloud read_cloud(const std::filesystem::path& path,
                      const ReadOptions& options,
                      const RunContext& context = {});

// Whom a reader hands the points to, in the file's order, as they are read.
struct CloudSink {
  // What a block has, but for the last, which has fewer, and the first, which has thousands at
  // least. All have the same origin and viewpoints; a cloud of one block alone stays organised.
  std::size_t block_points = std::numeric_limits<std::size_t>::max();
  std::function<void(PointCloud)> take;  // what it throws ends the reading
};

// read_cloud for a file of which no more than a block and a few megabytes are to be in memory.
// Held whole all the same are OBJ, STL and PLY meshes, with what is sampled from them, as one
// block; and the body of a compressed PCD file, packed and unpacked, each of which is at most 4
// GiB.
void read_cloud_in_blocks(const std::filesystem::path& path,
                          const ReadOptions& options,
                          const RunContext& context,
                          const CloudSink& sink);

// read_cloud for a file that is in memory. `name` is what messages call it; its extension helps
// where the content does not tell the format.
PointCloud parse_cloud(std::span<const std::byte> bytes,
                       std::string_view name,
                       const ReadOptions& options,
                       const RunContext& context = {});

}  // namespace landmarkdb
