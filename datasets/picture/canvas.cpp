#include "datasets/picture/canvas.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include <png.h>

#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

std::vector<png_byte> bytes_of(const Canvas& canvas) {
  std::vector<png_byte> bytes;
  bytes.reserve(canvas.pixels.size() * 3);
  for (const Colour& pixel : canvas.pixels) {
    for (int k = 0; k < 3; ++k) {
      bytes.push_back(
          static_cast<png_byte>(std::lround(255.0F * std::clamp(pixel[k], 0.0F, 1.0F))));
    }
  }
  return bytes;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw Error(ErrorCode::kResourceExhausted,
              path.string() + ": the picture cannot be written: " + why);
}

}  // namespace

void blend(Canvas& canvas, int x, int y, const Colour& colour, float alpha) {
  if (x < 0 || y < 0 || x >= canvas.width || y >= canvas.height || alpha <= 0.0F) return;
  Colour& pixel = canvas.at(x, y);
  pixel += std::min(alpha, 1.0F) * (colour - pixel);
}

void draw_line(Canvas& canvas,
               const Eigen::Vector2f& from,
               const Eigen::Vector2f& to,
               float width,
               const Colour& colour,
               float alpha) {
  const float half = 0.5F * width;
  const Eigen::Vector2f low = from.cwiseMin(to).array() - half - 1.0F;
  const Eigen::Vector2f high = from.cwiseMax(to).array() + half + 1.0F;
  const Eigen::Vector2f way = to - from;
  const float length2 = std::max(way.squaredNorm(), 1e-9F);
  const int x0 = std::max(0, static_cast<int>(std::max(low.x(), 0.0F)));
  const int y0 = std::max(0, static_cast<int>(std::max(low.y(), 0.0F)));
  const int x1 = static_cast<int>(std::min(high.x(), static_cast<float>(canvas.width - 1)));
  const int y1 = static_cast<int>(std::min(high.y(), static_cast<float>(canvas.height - 1)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2f p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      const float t = std::clamp((p - from).dot(way) / length2, 0.0F, 1.0F);
      const float distance = (p - from - t * way).norm();
      blend(canvas, x, y, colour, alpha * std::clamp(half + 0.5F - distance, 0.0F, 1.0F));
    }
  }
}

void draw_disc(Canvas& canvas,
               const Eigen::Vector2f& centre,
               float radius,
               const Colour& colour,
               float alpha) {
  draw_line(canvas, centre, centre, 2.0F * radius, colour, alpha);
}

void fill_rectangle(Canvas& canvas, int x0, int y0, int x1, int y1, const Colour& colour) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) blend(canvas, x, y, colour, 1.0F);
  }
}

void write_png(const std::filesystem::path& path, const Canvas& canvas) {
  if (path.has_parent_path() && !std::filesystem::is_directory(path.parent_path())) {
    throw Error(ErrorCode::kInvalidArgument, path.string() + ": its folder does not exist");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(canvas.width);
  image.height = static_cast<png_uint_32>(canvas.height);
  image.format = PNG_FORMAT_RGB;
  const std::vector<png_byte> bytes = bytes_of(canvas);
  // Not png_image_write_to_file: where that fails it removes what it was told to write to, a device
  // of the system too.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"),
                                                             &std::fclose);
  if (!file) refuse(path, std::strerror(errno));
  if (png_image_write_to_stdio(&image, file.get(), 0, bytes.data(), 0, nullptr) == 0) {
    refuse(path, static_cast<const char*>(image.message));
  }
  if (std::fflush(file.get()) != 0) refuse(path, std::strerror(errno));
}

}  // namespace landmarkdb::datasets
