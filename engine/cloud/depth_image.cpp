#include "engine/cloud/depth_image.hpp"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <png.h>

#include "engine/base/error.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb {
namespace {

// What libpng's callbacks see. It reports errors by longjmp, over whose frames nothing with a
// destructor may live: all memory belongs to the caller.
struct PngSource {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  char message[128] = {};
};

struct PngSize {
  std::uint32_t width = 0, height = 0;
  int bits = 0, colour_type = 0;
};

extern "C" {

void read_from_source(png_structp png, png_bytep out, std::size_t count) {
  auto* source = static_cast<PngSource*>(png_get_io_ptr(png));
  if (source->bytes.size() - source->at < count) png_error(png, "the file ends early");
  std::memcpy(out, source->bytes.data() + source->at, count);
  source->at += count;
}

void keep_error(png_structp png, png_const_charp message) {
  auto* source = static_cast<PngSource*>(png_get_error_ptr(png));
  std::strncpy(source->message, message, sizeof(source->message) - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

}  // extern "C"

struct PngHandles {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~PngHandles() { png_destroy_read_struct(&png, &info, nullptr); }
};

// False on an error; its text is then in the source. No object with a destructor in here.
bool read_size(PngHandles& handles, PngSource& source, PngSize& size) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  png_set_read_fn(handles.png, &source, read_from_source);
  png_read_info(handles.png, handles.info);
  size.width = png_get_image_width(handles.png, handles.info);
  size.height = png_get_image_height(handles.png, handles.info);
  size.bits = png_get_bit_depth(handles.png, handles.info);
  size.colour_type = png_get_color_type(handles.png, handles.info);
  return true;
}

bool read_rows(PngHandles& handles, png_bytepp rows) {
  if (setjmp(png_jmpbuf(handles.png)) != 0) return false;
  if constexpr (std::endian::native == std::endian::little) png_set_swap(handles.png);
  png_set_interlace_handling(handles.png);
  png_read_update_info(handles.png, handles.info);
  png_read_image(handles.png, rows);
  png_read_end(handles.png, nullptr);
  return true;
}

void check_size(const Input& input, const PngSize& size, const Camera& camera) {
  constexpr int kDepthBits = 16;
  if (size.bits != kDepthBits || size.colour_type != PNG_COLOR_TYPE_GRAY) {
    refuse(input,
           "a PNG of " + std::to_string(size.bits) + " bits " +
               (size.colour_type == PNG_COLOR_TYPE_GRAY ? "grey" : "in colour") +
               ", want a depth image: 16 bits grey");
  }
  if (size.width != camera.width || size.height != camera.height) {
    refuse(input,
           "an image of " + std::to_string(size.width) + " x " + std::to_string(size.height) +
               " pixels, but the camera file is for " + std::to_string(camera.width) + " x " +
               std::to_string(camera.height));
  }
}

std::vector<std::uint16_t> read_depths(const Input& input, const Camera& camera) {
  PngSource source{input.bytes};
  PngHandles handles;
  handles.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keep_error, ignore_warning);
  if (handles.png != nullptr) handles.info = png_create_info_struct(handles.png);
  if (handles.info == nullptr) {
    throw Error(ErrorCode::kResourceExhausted, "no memory for the PNG reader");
  }
  PngSize size;
  if (!read_size(handles, source, size)) {
    refuse(input, "no PNG that can be read: " + std::string(source.message));
  }
  check_size(input, size, camera);
  std::vector<std::uint16_t> depths(std::size_t{size.width} * size.height);
  std::vector<png_bytep> rows(size.height);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    rows[v] = reinterpret_cast<png_bytep>(depths.data() + v * size.width);
  }
  if (!read_rows(handles, rows.data())) {
    refuse(input, "a damaged PNG: " + std::string(source.message));
  }
  return depths;
}

}  // namespace

PointCloud parse_depth_image(std::span<const std::byte> bytes,
                             std::string_view name,
                             const Camera& camera) {
  const Input input{bytes, name};
  if (!(camera.depth_scale > 0.0)) {
    refuse(input, "a depth image needs depth_scale (raw units per metre) in its camera file");
  }
  const std::vector<std::uint16_t> depths = read_depths(input, camera);
  constexpr std::uint16_t kSaturated = std::numeric_limits<std::uint16_t>::max();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.width = camera.width;
  cloud.height = camera.height;
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  cloud.points.reserve(depths.size());
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      const std::uint16_t raw = depths[std::size_t{v} * camera.width + u];
      const std::optional<Eigen::Vector2d> ray =
          raw == 0 || raw == kSaturated ? std::nullopt : undistort(camera, {u, v});
      if (!ray) {
        cloud.points.emplace_back(kNan, kNan, kNan);
        continue;
      }
      const double z_m = raw / camera.depth_scale;
      cloud.points.emplace_back(Eigen::Vector3d(ray->x() * z_m, ray->y() * z_m, z_m).cast<float>());
    }
  }
  return cloud;
}

PointCloud read_depth_image(const std::filesystem::path& path, const Camera& camera) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30U;
  const FileBytes file = read_whole_file(path, kMostBytes);
  return parse_depth_image(file.span(), path.string(), camera);
}

}  // namespace landmarkdb
