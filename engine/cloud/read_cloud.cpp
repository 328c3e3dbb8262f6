#include "engine/cloud/read_cloud.hpp"

#include <algorithm>
#include <new>
#include <string>
#include <utility>

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

namespace {

// Hands over what is in the input, of which all is in memory, but for clouds of many points.
void parse_into(const Input& input, const ReadOptions& options, const CloudSink& sink) {
  try {
    switch (recognise_format(input)) {
      case CloudFormat::kPly:
        return parse_ply(input, options, sink);
      case CloudFormat::kPcd:
        return parse_pcd(input, options, sink);
      case CloudFormat::kText:
        return parse_text_cloud(input, options, sink);
      case CloudFormat::kObj:
        return sink.take(parse_obj(input, options));
      case CloudFormat::kBinaryStl:
        return sink.take(parse_binary_stl(input, options));
      case CloudFormat::kAsciiStl:
        return sink.take(parse_ascii_stl(input, options));
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kResourceExhausted,
                std::string(input.name) + ": not enough memory for its points");
  }
  refuse(input, "is in no format that can be read");
}

// From its first bytes.
bool is_read_whole(const Input& input) {
  const CloudFormat format = recognise_format(input);
  return format == CloudFormat::kObj || format == CloudFormat::kBinaryStl ||
         format == CloudFormat::kAsciiStl;
}

// A sink for all points at once.
CloudSink into(PointCloud& cloud) {
  return {.take = [&cloud](PointCloud whole) { cloud = std::move(whole); }};
}

}  // namespace

PointCloud parse_cloud(std::span<const std::byte> bytes,
                       std::string_view name,
                       const ReadOptions& options,
                       const RunContext& context) {
  PointCloud cloud;
  parse_into({bytes, name, &context}, options, into(cloud));
  return cloud;
}

void read_cloud_in_blocks(const std::filesystem::path& path,
                          const ReadOptions& options,
                          const RunContext& context,
                          const CloudSink& sink) {
  constexpr std::uint64_t kMostBytesPerPoint = 512;               // text with many columns
  constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 40U;  // keeps the product in 64 bits
  const InputFile file(path, std::min(options.max_points, kMostPoints) * kMostBytesPerPoint);
  const RestOfFile rest{&file, options.window_bytes};
  FileBytes front = read_front(file, options.window_bytes, context);
  if (front.size < file.size() && is_read_whole({front.span(), file.name(), &context, rest})) {
    front = {};
    front = read_front(file, file.size(), context);
  }
  // Nothing more to come, or cut off since it was opened: what is here is all.
  const bool all = front.size == file.size() || front.size < options.window_bytes;
  const Input input{front.span(), file.name(), &context, all ? RestOfFile{} : rest};
  parse_into(input, options, sink);
}

PointCloud read_cloud(const std::filesystem::path& path,
                      const ReadOptions& options,
                      const RunContext& context) {
  PointCloud cloud;
  read_cloud_in_blocks(path, options, context, into(cloud));
  return cloud;
}

}  // namespace landmarkdb
