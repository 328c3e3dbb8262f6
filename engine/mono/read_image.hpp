#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "engine/base/run_context.hpp"
#include "engine/types/grey_image.hpp"

namespace landmarkdb {

struct ReadImageOptions {
  // Larger images are refused before memory is taken: 50 megapixels are more than machine vision
  // cameras have, and take about a second to search.
  std::uint64_t max_pixels = 50'000'000;
};

// Reads a PNG, JPEG, or PGM/PPM (binary P5 and P6, text P2 and P3) as 8-bit grey. What it is
// follows from the first bytes, not from the name.
//
// Colour becomes luma (0.299 red + 0.587 green + 0.114 blue, which a JPEG has stored already), 16
// bits or another maximum are scaled to 0..255, alpha is dropped. Values are taken as they are
// stored: no gamma, no colour profile, no EXIF rotation (which would not fit the camera file).
//
// Throws Error{kInvalidArgument} that names the file and what was seen: another format, no pixels,
// more than `max_pixels`, a file that ends early or is damaged.
GreyImage read_image(const std::filesystem::path& path,
                     const ReadImageOptions& options = {},
                     const RunContext& run = {});

// The same for a file that is in memory; `name` is what messages call it.
GreyImage parse_image(std::span<const std::byte> bytes,
                      std::string_view name,
                      const ReadImageOptions& options = {});

}  // namespace landmarkdb
