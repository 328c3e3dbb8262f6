#include "engine/cloud/depth_image.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_png.hpp"

namespace landmarkdb {
namespace {

void check_size(const Input& input, const PngHeader& size, const Camera& camera) {
  constexpr int kDepthBits = 16;
  if (size.bits != kDepthBits || !size.grey) {
    refuse(input,
           "a PNG of " + std::to_string(size.bits) + " bits " + (size.grey ? "grey" : "in colour") +
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
  PngReader reader(input);
  check_size(input, reader.header(), camera);
  return reader.read_grey16();
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
