#include <optional>
#include <string>

#include "engine/cloud/read_png.hpp"
#include "engine/mono/image_formats.hpp"

namespace landmarkdb {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// The numbers of a PNM file, as the format's page (netpbm, pgm(5)) has them: decimal, apart by
// white space, with comments from # to the end of the line.
class Numbers {
 public:
  Numbers(const Input& input, std::size_t at) : input_(input), text_(input.text()), at_(at) {}

  std::uint32_t next(std::string_view what, std::uint32_t largest) {
    skip_space();
    const std::size_t start = at_;
    std::uint64_t value = 0;
    while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') {
      value = value * 10 + static_cast<std::uint64_t>(text_[at_++] - '0');
      if (value > largest) {
        refuse(input_,
               std::string(what) + " above " + std::to_string(largest) + " at byte " +
                   std::to_string(start));
      }
    }
    if (at_ == start) {
      refuse(input_,
             at_ == text_.size()
                 ? "ends before " + std::string(what)
                 : "want " + std::string(what) + " at byte " + std::to_string(start) + ", found " +
                       in_quotes(text_.substr(start, 1)));
    }
    return static_cast<std::uint32_t>(value);
  }

  std::size_t at() const { return at_; }

 private:
  void skip_space() {
    while (at_ < text_.size() && (is_space(text_[at_]) || text_[at_] == '#')) {
      if (text_[at_] == '#') {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      } else {
        ++at_;
      }
    }
  }

  const Input& input_;
  std::string_view text_;
  std::size_t at_;
};

struct PnmHeader {
  std::uint32_t width = 0, height = 0;
  std::uint32_t largest = 0;  // the value of white
  std::size_t channels = 1;
  std::size_t end = 0;  // where the pixels start
};

std::uint8_t to_8_bits(std::uint32_t value, std::uint32_t largest) {
  return static_cast<std::uint8_t>((value * 255U + largest / 2) / largest);
}

PnmHeader read_header(const Input& input, char kind) {
  constexpr std::uint32_t kLongestSide = 0x7fffffff;
  constexpr std::uint32_t kMostValue = 65535;  // the format's
  Numbers numbers(input, 2);
  PnmHeader header;
  header.width = numbers.next("the width", kLongestSide);
  header.height = numbers.next("the height", kLongestSide);
  header.largest = numbers.next("the largest value", kMostValue);
  if (header.largest == 0) refuse(input, "a largest value of 0, want 1 to 65535");
  header.channels = kind == '3' || kind == '6' ? 3 : 1;
  header.end = numbers.at();
  return header;
}

// `next` gives the next value, 0 to 255; the caller has seen that there are enough of them.
template <typename Next>
void fill(GreyImage& image, std::size_t channels, const Next& next) {
  for (std::uint8_t& pixel : image.pixels) {
    if (channels == 1) {
      pixel = next();
      continue;
    }
    const std::uint8_t red = next(), green = next(), blue = next();
    pixel = luma_of(red, green, blue);
  }
}

}  // namespace

GreyImage parse_pnm_image(const Input& input, std::uint64_t max_pixels) {
  const std::string_view text = input.text();
  const char kind = text[1];
  if (kind == '1' || kind == '4' || kind == '7') {
    refuse(
        input,
        "a PNM image of kind P" + std::string(1, kind) + ", want P2, P3, P5 or P6 (grey, colour)");
  }
  const PnmHeader header = read_header(input, kind);
  check_image_size(input, header.width, header.height, max_pixels);
  const bool binary = kind == '5' || kind == '6';
  const std::size_t bytes_each = binary && header.largest > 255 ? 2 : 1;
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  const std::size_t start = header.end + (binary ? 1 : 0);  // one white space ends a binary header
  if (binary && (header.end >= text.size() || !is_space(text[header.end]))) {
    refuse(input, "want one white space after the largest value");
  }
  // In text each value takes two bytes, the last one but one.
  const std::uint64_t least = header.channels * (binary ? bytes_each : 2);
  check_count(input, pixels, least, text.size() - start + (binary ? 0 : 1), max_pixels, "pixels");
  GreyImage image{header.width, header.height, std::vector<std::uint8_t>(pixels)};
  if (binary) {
    const auto* at = reinterpret_cast<const std::uint8_t*>(text.data()) + start;
    fill(image, header.channels, [&] {
      std::uint32_t value = *at++;
      if (bytes_each == 2) value = value * 256U + *at++;
      if (value > header.largest) refuse(input, "a value above the largest the header allows");
      return to_8_bits(value, header.largest);
    });
  } else {
    Numbers numbers(input, start);
    fill(image, header.channels, [&] {
      return to_8_bits(numbers.next("a pixel's value", header.largest), header.largest);
    });
  }
  return image;
}

}  // namespace landmarkdb
