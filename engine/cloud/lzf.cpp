#include "engine/cloud/lzf.hpp"

#include <algorithm>
#include <cstdint>

namespace landmarkdb {

// A control byte below 32 is followed by that many plus one literal bytes. Any other starts a back
// reference: three bits of length (7: one more byte adds to it), then 13 bits of distance; it
// copies length + 2 bytes from distance + 1 bytes back.
bool lzf_decompress(std::span<const std::byte> packed, std::span<std::byte> out) {
  constexpr std::size_t kLiterals = 32;
  constexpr std::size_t kLongLength = 7;
  std::size_t from = 0;
  std::size_t to = 0;
  auto byte_at = [&](std::size_t i) { return static_cast<std::size_t>(packed[i]); };
  while (from < packed.size()) {
    const std::size_t control = byte_at(from++);
    if (control < kLiterals) {
      const std::size_t count = control + 1;
      if (packed.size() - from < count || out.size() - to < count) return false;
      std::copy_n(packed.begin() + static_cast<std::ptrdiff_t>(from),
                  count,
                  out.begin() + static_cast<std::ptrdiff_t>(to));
      from += count;
      to += count;
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == kLongLength) {
      if (from == packed.size()) return false;
      length += byte_at(from++);
    }
    if (from == packed.size()) return false;
    const std::size_t distance = ((control & 31U) << 8U) + byte_at(from++) + 1;
    length += 2;
    if (distance > to || out.size() - to < length) return false;
    // Byte by byte: the source may overlap what is being written.
    for (std::size_t k = 0; k < length; ++k, ++to) out[to] = out[to - distance];
  }
  return to == out.size();
}

}  // namespace landmarkdb
