#include "engine/cloud/read_cloud.hpp"

#include <algorithm>
#include <new>
#include <string>

#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"
#include "engine/cloud/read_mesh.hpp"
#include "engine/cloud/read_pcd.hpp"
#include "engine/cloud/read_ply.hpp"
#include "engine/cloud/read_text.hpp"
#include "engine/cloud/recognise_format.hpp"

namespace landmarkdb {

double metres_per(Units units) {
  switch (units) {
    case Units::kMetres:
      return 1.0;
    case Units::kMillimetres:
      return 0.001;
    case Units::kCentimetres:
      return 0.01;
    case Units::kInches:
      return 0.0254;
  }
  return 1.0;
}

PointCloud parse_cloud(std::span<const std::byte> bytes,
                       std::string_view name,
                       const ReadOptions& options,
                       const RunContext& context) {
  const Input input{bytes, name, &context};
  try {
    switch (recognise_format(input)) {
      case CloudFormat::kPly:
        return parse_ply(input, options);
      case CloudFormat::kPcd:
        return parse_pcd(input, options);
      case CloudFormat::kText:
        return parse_text_cloud(input, options);
      case CloudFormat::kObj:
        return parse_obj(input, options);
      case CloudFormat::kBinaryStl:
        return parse_binary_stl(input, options);
      case CloudFormat::kAsciiStl:
        return parse_ascii_stl(input, options);
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kResourceExhausted,
                std::string(name) + ": not enough memory for its points");
  }
  refuse(input, "is in no format that can be read");
}

PointCloud read_cloud(const std::filesystem::path& path,
                      const ReadOptions& options,
                      const RunContext& context) {
  constexpr std::uint64_t kMostBytesPerPoint = 512;               // text with many columns
  constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40U;  // keeps the product in 64 bits
  const FileBytes file = read_whole_file(
      path, std::min(options.max_points, kMostPoints) * kMostBytesPerPoint, context);
  return parse_cloud(file.span(), path.string(), options, context);
}

}  // namespace landmarkdb
