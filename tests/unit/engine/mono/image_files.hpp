#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/types/grey_image.hpp"

namespace landmarkdb::testing {

struct NamedImage {
  std::string name;
  std::string bytes;
};

// A picture with a ramp and a bright box.
GreyImage sample_image(std::uint32_t width, std::uint32_t height);

struct PngWish {
  int bits = 8;
  int colour_type = 0;  // as libpng numbers them: 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGBA
  bool interlaced = false;
};

// Rows as libpng wants them: `row_bytes` bytes each. A palette is red, green, blue, white.
std::string png_file(std::uint32_t width,
                     std::uint32_t height,
                     std::span<const std::uint8_t> rows,
                     const PngWish& wish);
std::string png_file(const GreyImage& image);

// 1 or 3 values a pixel.
std::string jpeg_file(std::uint32_t width,
                      std::uint32_t height,
                      std::span<const std::uint8_t> values,
                      int channels,
                      bool progressive = false);

std::string pgm_file(const GreyImage& image);       // P5
std::string pgm_text_file(const GreyImage& image);  // P2

// A small valid file of each kind that can be read.
std::vector<NamedImage> one_image_of_each();

}  // namespace landmarkdb::testing
