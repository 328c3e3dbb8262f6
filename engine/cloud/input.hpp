#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// The bytes of a file, the name to use in messages about it, and whom to ask whether to go on.
struct Input {
  std::span<const std::byte> bytes;
  std::string_view name;
  const RunContext* context = nullptr;  // null: to the end, and nobody is told

  // For the loops over what the file holds, with the turn's number: now and then, tells that the
  // first `at` bytes are done with, as the stage "read", and throws where the job shall stop.
  void tick(std::uint64_t turn, std::uint64_t at) const {
    constexpr std::uint64_t kTurns = 8192;  // a millisecond or two of parsing
    if (context != nullptr && turn % kTurns == 0) context->report("read", at, bytes.size());
  }

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
// `max_bytes`, or where there is none; Error{kResourceExhausted} without memory; what
// `context.check` throws.
FileBytes read_whole_file(const std::filesystem::path& path,
                          std::uint64_t max_bytes,
                          const RunContext& context = {});

}  // namespace landmarkdb
