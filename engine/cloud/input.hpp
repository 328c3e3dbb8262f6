#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace landmarkdb {

// The bytes of a file and the name to use in messages about it.
struct Input {
  std::span<const std::byte> bytes;
  std::string_view name;

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
};

// Throws Error{kInvalidArgument}: "<name>: <what>".
[[noreturn]] void refuse(const Input& input, const std::string& what);

// A piece of untrusted text as it may stand in a message: quoted, cut short, unprintable bytes as
// "?".
std::string in_quotes(std::string_view text);

// Throws unless `count` records of at least `bytes_each` fit into `available` bytes and `count` is
// at most `max_count`. Never overflows. `what` names the records in the message ("points").
void check_count(const Input& input,
                 std::uint64_t count,
                 std::uint64_t bytes_each,
                 std::uint64_t available,
                 std::uint64_t max_count,
                 std::string_view what);

// A whole file in memory.
struct FileBytes {
  std::unique_ptr<std::byte[]> data;
  std::size_t size = 0;
  std::span<const std::byte> span() const { return {data.get(), size}; }
};

// Throws Error{kInvalidArgument} for what is not a readable regular file, or is larger than
// `max_bytes`, or where there is none; Error{kResourceExhausted} without memory.
FileBytes read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes);

}  // namespace landmarkdb
