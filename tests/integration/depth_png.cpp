#include "tests/integration/depth_png.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <png.h>

namespace landmarkdb::testing {

void write_depth_png(const std::string& path, const PointCloud& cloud, double depth_scale) {
  std::vector<std::uint16_t> pixels;
  for (const Eigen::Vector3f& point : cloud.points) {
    const double units = std::isfinite(point.z()) ? point.z() * depth_scale : 0.0;
    pixels.push_back(static_cast<std::uint16_t>(std::lround(units)));
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = cloud.width;
  image.height = cloud.height;
  image.format = PNG_FORMAT_LINEAR_Y;  // 16 bits, as they are
  if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr) == 0) {
    throw std::runtime_error("cannot write " + path);
  }
}

}  // namespace landmarkdb::testing
