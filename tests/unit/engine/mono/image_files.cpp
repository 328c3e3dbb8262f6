#include "tests/unit/engine/mono/image_files.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>
#include <png.h>

namespace landmarkdb::testing {
namespace {

void append_bytes(png_structp png, png_bytep data, std::size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

std::vector<std::uint8_t> three_of_each(const GreyImage& image) {
  std::vector<std::uint8_t> colours;
  for (const std::uint8_t value : image.pixels) {
    colours.insert(colours.end(), {value, static_cast<std::uint8_t>(255 - value), 90});
  }
  return colours;
}

}  // namespace

GreyImage sample_image(std::uint32_t width, std::uint32_t height) {
  GreyImage image{width, height, {}};
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      const bool box = u > width / 4 && u < width / 2 && v > height / 4 && v < height / 2;
      image.pixels.push_back(static_cast<std::uint8_t>(box ? 250 : (u * 3 + v * 5) % 200));
    }
  }
  return image;
}

std::string png_file(std::uint32_t width,
                     std::uint32_t height,
                     std::span<const std::uint8_t> rows,
                     const PngWish& wish) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, append_bytes, nullptr);
  png_set_IHDR(png,
               info,
               width,
               height,
               wish.bits,
               wish.colour_type,
               wish.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               0,
               0);
  if (wish.colour_type == PNG_COLOR_TYPE_PALETTE) {
    static constexpr png_color kColours[4] = {
        {255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
    png_set_PLTE(png, info, kColours, 4);
  }
  png_write_info(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  std::vector<png_bytep> starts(height);
  for (std::size_t v = 0; v < height; ++v) {
    starts[v] = const_cast<png_bytep>(rows.data() + v * row_bytes);  // libpng only reads it
  }
  png_write_image(png, starts.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return file;
}

std::string png_file(const GreyImage& image) {
  return png_file(image.width, image.height, image.pixels, {});
}

std::string jpeg_file(std::uint32_t width,
                      std::uint32_t height,
                      std::span<const std::uint8_t> values,
                      int channels,
                      bool progressive) {
  jpeg_compress_struct state{};
  jpeg_error_mgr errors{};
  state.err = jpeg_std_error(&errors);
  jpeg_create_compress(&state);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&state, &out, &size);
  state.image_width = width;
  state.image_height = height;
  state.input_components = channels;
  state.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&state);
  jpeg_set_quality(&state, 95, TRUE);
  if (progressive) jpeg_simple_progression(&state);
  jpeg_start_compress(&state, TRUE);
  const std::size_t pitch = std::size_t{width} * static_cast<std::size_t>(channels);
  while (state.next_scanline < height) {
    auto* row = const_cast<JSAMPROW>(values.data() + state.next_scanline * pitch);
    jpeg_write_scanlines(&state, &row, 1);
  }
  jpeg_finish_compress(&state);
  jpeg_destroy_compress(&state);
  std::string file(reinterpret_cast<const char*>(out), size);
  std::free(out);
  return file;
}

std::string pgm_file(const GreyImage& image) {
  return "P5\n# a comment\n" + std::to_string(image.width) + " " + std::to_string(image.height) +
         "\n255\n" +
         std::string(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size());
}

std::string pgm_text_file(const GreyImage& image) {
  std::string file =
      "P2 " + std::to_string(image.width) + " " + std::to_string(image.height) + " 255\n";
  for (const std::uint8_t value : image.pixels) file += std::to_string(value) + "\n";
  return file;
}

std::vector<NamedImage> one_image_of_each() {
  const GreyImage image = sample_image(40, 30);
  const std::vector<std::uint8_t> colours = three_of_each(image);
  std::string colour_map = "P6 40 30 255\n";
  colour_map.append(reinterpret_cast<const char*>(colours.data()), colours.size());
  return {{"grey.png", png_file(image)},
          {"interlaced.png", png_file(40, 30, colours, {8, PNG_COLOR_TYPE_RGB, true})},
          {"grey.jpg", jpeg_file(40, 30, image.pixels, 1)},
          {"colour.jpg", jpeg_file(40, 30, colours, 3)},
          {"progressive.jpg", jpeg_file(40, 30, colours, 3, true)},
          {"binary.pgm", pgm_file(image)},
          {"text.pgm", pgm_text_file(image)},
          {"colour.ppm", colour_map}};
}

}  // namespace landmarkdb::testing
