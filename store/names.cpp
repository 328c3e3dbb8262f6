#include "store/names.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMaxNameCharacters = 128;
constexpr std::size_t kMaxValueCharacters = 1024;

// Takes one character off the front of `text`; nothing where the bytes are not valid UTF-8
// (RFC 3629: shortest form only, no surrogates, at most U+10FFFF).
std::optional<std::uint32_t> take_character(std::string_view& text) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::uint32_t first = byte(0);
  std::size_t length = 1;
  std::uint32_t value = first;
  std::uint32_t smallest = 0;
  if (first >= 0x80) {
    if ((first & 0xe0U) == 0xc0U) {
      length = 2, value = first & 0x1fU, smallest = 0x80;
    } else if ((first & 0xf0U) == 0xe0U) {
      length = 3, value = first & 0x0fU, smallest = 0x800;
    } else if ((first & 0xf8U) == 0xf0U) {
      length = 4, value = first & 0x07U, smallest = 0x10000;
    } else {
      return std::nullopt;
    }
  }
  if (text.size() < length) return std::nullopt;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return std::nullopt;
    value = (value << 6U) | (byte(i) & 0x3fU);
  }
  if (value < smallest || value > 0x10ffff || (value >= 0xd800 && value <= 0xdfff)) {
    return std::nullopt;
  }
  text.remove_prefix(length);
  return value;
}

// Control characters, and those that are not seen or reorder what is: two names must not look
// alike for them.
bool is_unprintable(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c <= 0x9f) || (c >= 0x200b && c <= 0x200f) ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2060 && c <= 0x206f) || c == 0xfeff ||
         (c >= 0xfff0 && c <= 0xfffb) || (c & 0xfffeU) == 0xfffeU;
}

[[noreturn]] void refuse(std::string_view what, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, std::string(what) + " " + why, "name");
}

// The number of characters; refuses what is not printable UTF-8.
std::size_t count_characters(std::string_view text, std::string_view what) {
  std::size_t count = 0;
  while (!text.empty()) {
    const std::optional<std::uint32_t> character = take_character(text);
    if (!character) refuse(what, "is not valid UTF-8");
    if (is_unprintable(*character)) refuse(what, "has a control or invisible character");
    ++count;
  }
  return count;
}

}  // namespace

void validate_name(std::string_view name, std::string_view what) {
  if (name.empty()) refuse(what, "is empty, want 1 to 128 characters");
  const std::size_t count = count_characters(name, what);
  if (count > kMaxNameCharacters) {
    refuse(what, "has " + std::to_string(count) + " characters, want at most 128");
  }
  if (name.find('/') != std::string_view::npos) {
    refuse(what, "'" + std::string(name) + "' has a '/'");
  }
  if (name.front() == ' ' || name.back() == ' ') {
    refuse(what, "'" + std::string(name) + "' begins or ends with a space");
  }
}

void validate_tag_value(std::string_view value) {
  const std::size_t count = count_characters(value, "tag value");
  if (count > kMaxValueCharacters) {
    refuse("tag value", "has " + std::to_string(count) + " characters, want at most 1024");
  }
}

}  // namespace landmarkdb
