#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb::datasets {

using Colour = Eigen::Vector3f;  // red, green, blue, 0..1, as shown on a screen

// A picture: row-major, top row first; pixel (x, y) covers [x, x + 1) x [y, y + 1).
struct Canvas {
  int width = 0, height = 0;
  std::vector<Colour> pixels;

  Canvas(int w, int h, const Colour& background)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), background) {}
  Colour& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

// Lays colour over a pixel; nothing happens outside the picture.
void blend(Canvas& canvas, int x, int y, const Colour& colour, float alpha);

// A line with round ends, edges smoothed. Pixels.
void draw_line(Canvas& canvas,
               const Eigen::Vector2f& from,
               const Eigen::Vector2f& to,
               float width,
               const Colour& colour,
               float alpha = 1.0F);

// A filled circle.
void draw_disc(Canvas& canvas,
               const Eigen::Vector2f& centre,
               float radius,
               const Colour& colour,
               float alpha = 1.0F);

void fill_rectangle(Canvas& canvas, int x0, int y0, int x1, int y1, const Colour& colour);

// Text in a stroke font; `at` is the left end of the base line, `size` the height of a capital in
// pixels. Characters the font lacks are drawn as a small box.
void draw_text(Canvas& canvas,
               const Eigen::Vector2f& at,
               std::string_view text,
               float size,
               const Colour& colour);
float text_width(std::string_view text, float size);

// Throws Error{kInvalidArgument} for a path that cannot be opened, Error{kResourceExhausted} when
// the disk is full.
void write_png(const std::filesystem::path& path, const Canvas& canvas);

}  // namespace landmarkdb::datasets
