#pragma once

#include <cstdint>

#include "engine/cloud/input.hpp"
#include "engine/types/grey_image.hpp"

// The readers behind read_image. Each throws Error{kInvalidArgument} as it says there.
namespace landmarkdb {

// Throws for an image without pixels, or with more than `max_pixels`.
void check_image_size(const Input& input,
                      std::uint64_t width,
                      std::uint64_t height,
                      std::uint64_t max_pixels);

GreyImage parse_png_image(const Input& input, std::uint64_t max_pixels);
GreyImage parse_jpeg_image(const Input& input, std::uint64_t max_pixels);
GreyImage parse_pnm_image(const Input& input, std::uint64_t max_pixels);

}  // namespace landmarkdb
