#include "engine/mono/read_image.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/mono/image_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

GreyImage parse(const std::string& bytes, const ReadImageOptions& options = {}) {
  return parse_image(std::as_bytes(std::span(bytes)), "photo", options);
}

int largest_difference(const GreyImage& a, const GreyImage& b) {
  int largest = a.width == b.width && a.height == b.height ? 0 : 1000;
  for (std::size_t i = 0; largest < 1000 && i < a.pixels.size(); ++i) {
    largest = std::max(largest, std::abs(a.pixels[i] - b.pixels[i]));
  }
  return largest;
}

TEST(ReadImage, GivesTheGreyValuesOfPngAndPgmAsTheyAre) {
  const GreyImage image = testing::sample_image(23, 17);
  EXPECT_EQ(largest_difference(parse(testing::png_file(image)), image), 0);
  EXPECT_EQ(largest_difference(parse(testing::pgm_file(image)), image), 0);
  EXPECT_EQ(largest_difference(parse(testing::pgm_text_file(image)), image), 0);
  const std::string interlaced = testing::png_file(23, 17, image.pixels, {8, 0, true});
  EXPECT_EQ(largest_difference(parse(interlaced), image), 0);
}

TEST(ReadImage, GivesTheGreyValuesOfAJpegNearly) {
  GreyImage image{32, 24, {}};
  for (int i = 0; i < 32 * 24; ++i) image.pixels.push_back(static_cast<std::uint8_t>(i % 32 * 7));
  EXPECT_LE(largest_difference(parse(testing::jpeg_file(32, 24, image.pixels, 1)), image), 4);
  EXPECT_LE(largest_difference(parse(testing::jpeg_file(32, 24, image.pixels, 1, true)), image), 4);
}

TEST(ReadImage, TakesTheLumaOfColours) {
  const std::vector<std::uint8_t> rgb{255, 0, 0, 0, 255, 0, 0, 0, 255, 100, 100, 100};
  EXPECT_THAT(parse(testing::png_file(4, 1, rgb, {8, 2})).pixels, ElementsAre(76, 150, 29, 100));
  EXPECT_THAT(parse(testing::png_file(4, 1, rgb, {8, 2, true})).pixels,
              ElementsAre(76, 150, 29, 100));
  const std::string raw(rgb.begin(), rgb.end());
  EXPECT_THAT(parse("P6 4 1 255\n" + raw).pixels, ElementsAre(76, 150, 29, 100));
  EXPECT_THAT(parse("P3 1 1 255 255 0 0").pixels, ElementsAre(76));
  const std::vector<std::uint8_t> indices{0b00011011};
  EXPECT_THAT(parse(testing::png_file(4, 1, indices, {2, 3})).pixels,
              ElementsAre(76, 150, 29, 255));
  std::vector<std::uint8_t> red;
  for (int i = 0; i < 256; ++i) red.insert(red.end(), {255, 0, 0});
  EXPECT_NEAR(parse(testing::jpeg_file(16, 16, red, 3)).pixels[100], 76, 2);
}

TEST(ReadImage, DropsAlphaAndScalesOtherDepths) {
  const std::vector<std::uint8_t> with_alpha{10, 0, 200, 255};
  EXPECT_THAT(parse(testing::png_file(2, 1, with_alpha, {8, 4})).pixels, ElementsAre(10, 200));
  const std::vector<std::uint8_t> deep{0xff, 0xff, 0x80, 0x80, 0, 0};
  EXPECT_THAT(parse(testing::png_file(3, 1, deep, {16, 0})).pixels, ElementsAre(255, 128, 0));
  const std::vector<std::uint8_t> bits{0b10100000};
  EXPECT_THAT(parse(testing::png_file(4, 1, bits, {1, 0})).pixels, ElementsAre(255, 0, 255, 0));
  EXPECT_THAT(parse(std::string("P5 2 1 65535\n\xff\xff\x80\x80", 17)).pixels,
              ElementsAre(255, 128));
  EXPECT_THAT(parse("P2 3 1 15 0 8 15").pixels, ElementsAre(0, 136, 255));
}

TEST(ReadImage, RefusesWhatIsNoImageAndSaysWhatItSaw) {
  EXPECT_THAT([] { parse(""); }, ThrowsMessage<Error>(HasSubstr("photo: an empty file")));
  EXPECT_THAT([] { parse("GIF89a...."); }, ThrowsMessage<Error>(HasSubstr("\"GIF89a..\"")));
  EXPECT_THAT([] { parse("P4 8 8 "); }, ThrowsMessage<Error>(HasSubstr("kind P4")));
  EXPECT_THAT([] { parse("P5 x"); }, ThrowsMessage<Error>(HasSubstr("want the width")));
  EXPECT_THAT([] { parse("P5 0 4 255\n"); }, ThrowsMessage<Error>(HasSubstr("0 x 4")));
  EXPECT_THAT([] { parse("P5 1 1 0\n1"); }, ThrowsMessage<Error>(HasSubstr("largest value of 0")));
  EXPECT_THAT([] { parse("P2 1 1 9 10"); }, ThrowsMessage<Error>(HasSubstr("above 9")));
  EXPECT_THAT([] { parse(std::string("P5 1 1 300\n\xff\xff", 13)); },
              ThrowsMessage<Error>(HasSubstr("above the largest")));
  EXPECT_THAT([] { parse("\x89PNG\r\n"); }, ThrowsMessage<Error>(HasSubstr("PNG")));
  EXPECT_THAT([] { parse("\xff\xd8"); }, ThrowsMessage<Error>(HasSubstr("JPEG")));
}

TEST(ReadImage, RefusesEveryFileThatEndsEarly) {
  for (const testing::NamedImage& file : testing::one_image_of_each()) {
    for (const double part : {0.3, 0.7, 0.95}) {
      const auto size = static_cast<std::size_t>(part * static_cast<double>(file.bytes.size()));
      EXPECT_THROW(parse(file.bytes.substr(0, size)), Error) << file.name << " cut at " << part;
    }
  }
}

TEST(ReadImage, RefusesMorePixelsThanTheLimitAndNamesIt) {
  const GreyImage image = testing::sample_image(40, 30);
  for (const testing::NamedImage& file : testing::one_image_of_each()) {
    EXPECT_THAT([&] { parse(file.bytes, {.max_pixels = 1199}); },
                ThrowsMessage<Error>(AllOf(HasSubstr("40 x 30"), HasSubstr("at most 1199"))))
        << file.name;
    EXPECT_EQ(parse(file.bytes, {.max_pixels = 1200}).pixels.size(), 1200U) << file.name;
  }
}

TEST(ReadImage, RefusesAHeaderThatPromisesMoreThanTheFileCanHold) {
  EXPECT_THAT([] { parse("P5 6000 6000 255\nabc"); }, ThrowsMessage<Error>(HasSubstr("promises")));
  std::string lie = testing::jpeg_file(8, 8, std::vector<std::uint8_t>(64, 9), 1);
  const std::size_t frame = lie.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  lie.replace(frame + 5, 4, std::string("\x17\x70\x17\x70", 4));  // 6000 x 6000
  EXPECT_THAT([&] { parse(lie); }, ThrowsMessage<Error>(HasSubstr("promises")));
}

TEST(ReadImage, ReadsAFileAndNamesOneThatIsNotThere) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "sample.pgm";
  const GreyImage image = testing::sample_image(9, 7);
  std::ofstream(path, std::ios::binary) << testing::pgm_file(image);
  EXPECT_EQ(largest_difference(read_image(path), image), 0);
  std::filesystem::remove(path);
  EXPECT_THAT([&] { read_image(path); }, ThrowsMessage<Error>(HasSubstr("sample.pgm")));
}

}  // namespace
}  // namespace landmarkdb
