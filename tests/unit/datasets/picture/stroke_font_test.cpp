#include <string>

#include <gtest/gtest.h>

#include "datasets/picture/canvas.hpp"

namespace landmarkdb::datasets {
namespace {

int ink(const std::string& text) {
  Canvas canvas(200, 60, Colour(1, 1, 1));
  draw_text(canvas, {10.0F, 40.0F}, text, 24.0F, Colour(0, 0, 0));
  int dark = 0;
  for (const Colour& pixel : canvas.pixels) dark += pixel.x() < 0.5F ? 1 : 0;
  return dark;
}

TEST(DrawText, DrawsEveryLetterAndDigitInItsOwnWay) {
  const std::string all =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.,:-+=/()%'_<>";
  for (const char character : all) {
    EXPECT_GT(ink(std::string(1, character)), 3) << character;
  }
  EXPECT_EQ(ink(" "), 0);
  EXPECT_GT(ink("\xE2"), 0) << "what the font lacks shows as a box";
}

TEST(TextWidth, GrowsWithTextAndSize) {
  EXPECT_EQ(text_width("", 12.0F), 0.0F);
  EXPECT_LT(text_width("in", 12.0F), text_width("inn", 12.0F));
  EXPECT_FLOAT_EQ(2.0F * text_width("scene", 12.0F), text_width("scene", 24.0F));
}

}  // namespace
}  // namespace landmarkdb::datasets
