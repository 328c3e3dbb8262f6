#pragma once

#include <cstddef>
#include <span>

namespace landmarkdb {

// The most bytes one byte of LZF data can unfold to: a three-byte back reference gives at most 264.
inline constexpr std::size_t kLzfMostPerByte = 88;

// Unpacks LZF data (Lehmann's LibLZF format, as PCD's binary_compressed uses it). True when the
// data is well-formed and fills `out` exactly; never reads or writes outside the two spans.
bool lzf_decompress(std::span<const std::byte> packed, std::span<std::byte> out);

}  // namespace landmarkdb
