#include "store/names.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/error.hpp"
#include "store/utf8.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMaxNameCharacters = 128;
constexpr std::size_t kMaxValueCharacters = 1024;

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
