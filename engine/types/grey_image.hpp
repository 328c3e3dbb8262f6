#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace landmarkdb {

// An 8-bit grey image, row by row from the top, without padding.
struct GreyImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> pixels{};  // width * height

  std::uint8_t at(std::size_t x, std::size_t y) const { return pixels[y * width + x]; }
};

}  // namespace landmarkdb
