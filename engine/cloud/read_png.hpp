#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/cloud/input.hpp"

namespace landmarkdb {

struct PngHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  int bits = 0;       // of a channel, as stored
  bool grey = false;  // neither colour, nor palette, nor alpha
};

// Reads one PNG that is in memory: first what it is, then, where that is wanted, its pixels.
//
// All throw Error{kInvalidArgument} that names the input. One use; not thread-safe.
class PngReader {
 public:
  // Reads the header. `input` must outlive the reader.
  explicit PngReader(const Input& input);
  ~PngReader();

  const PngHeader& header() const;

  // The pixels of a 16-bit grey PNG, row by row. Only where the header says it is one.
  std::vector<std::uint16_t> read_grey16();

  // The pixels as 8-bit grey, row by row, whatever is stored: palettes are looked up, 1 to 4 bits
  // stretched and 16 bits scaled to 0..255, alpha is dropped, colour becomes luma (luma_of).
  std::vector<std::uint8_t> read_grey8();

 private:
  void check_promise() const;

  class Impl;
  std::unique_ptr<Impl> impl_;
};

// The brightness of a colour as JPEG and analogue television weigh it (ITU-R BT.601), rounded.
inline std::uint8_t luma_of(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  constexpr std::uint32_t kRed = 19595, kGreen = 38470, kBlue = 7471;  // 0.299, 0.587, 0.114 x 2^16
  return static_cast<std::uint8_t>((kRed * red + kGreen * green + kBlue * blue + 32768U) >> 16U);
}

}  // namespace landmarkdb
