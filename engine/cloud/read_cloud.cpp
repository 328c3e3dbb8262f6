#include "engine/cloud/read_cloud.hpp"

#include <string>

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_ply.hpp"

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
                       const ReadOptions& options) {
  const Input input{bytes, name};
  if (input.text().starts_with("ply")) return parse_ply(input, options);
  refuse(input, "not a format that can be read");
}

PointCloud read_cloud(const std::filesystem::path& path, const ReadOptions& options) {
  constexpr std::uint64_t kMostBytesPerPoint = 256;  // text with many columns
  const FileBytes file = read_whole_file(path, options.max_points * kMostBytesPerPoint);
  return parse_cloud(file.span(), path.string(), options);
}

}  // namespace landmarkdb
