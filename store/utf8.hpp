#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace landmarkdb {

// Takes one character off the front of `text`, which is not empty; nothing, and nothing taken,
// where the bytes are not valid UTF-8 (RFC 3629: shortest form only, no surrogates, at most
// U+10FFFF).
std::optional<std::uint32_t> take_character(std::string_view& text);

// The text with each byte that is not part of valid UTF-8 replaced by U+FFFD: what comes out of a
// damaged file must not break the JSON or protobuf it is told in.
std::string valid_utf8(std::string_view text);

}  // namespace landmarkdb
