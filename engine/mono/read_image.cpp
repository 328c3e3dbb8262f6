#include "engine/mono/read_image.hpp"

#include <string>

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_png.hpp"
#include "engine/mono/image_formats.hpp"

namespace landmarkdb {

void check_image_size(const Input& input,
                      std::uint64_t width,
                      std::uint64_t height,
                      std::uint64_t max_pixels) {
  if (width > 0 && height > 0 && width <= max_pixels / height) return;
  refuse(input,
         "an image of " + std::to_string(width) + " x " + std::to_string(height) +
             " pixels, want at least 1 x 1 and at most " + std::to_string(max_pixels) +
             " pixels in all");
}

GreyImage parse_png_image(const Input& input, std::uint64_t max_pixels) {
  PngReader reader(input);
  const PngHeader& header = reader.header();
  check_image_size(input, header.width, header.height, max_pixels);
  return {header.width, header.height, reader.read_grey8()};
}

GreyImage parse_image(std::span<const std::byte> bytes,
                      std::string_view name,
                      const ReadImageOptions& options) {
  const Input input{bytes, name};
  const std::string_view text = input.text();
  if (text.empty()) refuse(input, "an empty file, want a PNG, JPEG or PGM image");
  if (text.starts_with("\x89PNG")) return parse_png_image(input, options.max_pixels);
  if (text.starts_with("\xff\xd8")) return parse_jpeg_image(input, options.max_pixels);
  if (text.size() >= 2 && text[0] == 'P' && (text[1] >= '1' && text[1] <= '7')) {
    return parse_pnm_image(input, options.max_pixels);
  }
  constexpr std::size_t kShown = 8;
  refuse(input, "starts with " + in_quotes(text.substr(0, kShown)) + ", want a PNG, JPEG or PGM");
}

GreyImage read_image(const std::filesystem::path& path,
                     const ReadImageOptions& options,
                     const RunContext& run) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30U;
  const FileBytes file = read_whole_file(path, kMostBytes, run);
  return parse_image(file.span(), path.string(), options);
}

}  // namespace landmarkdb
