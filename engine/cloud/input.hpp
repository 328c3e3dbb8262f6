#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/run_context.hpp"

namespace landmarkdb {

// A file that is open for reading, piece by piece.
class InputFile {
 public:
  // Throws Error{kInvalidArgument} for what is not a readable regular file, or is larger than
  // `max_bytes`.
  InputFile(const std::filesystem::path& path, std::uint64_t max_bytes);

  // What it had when it was opened.
  std::uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }

  // Fills `to` with the bytes from `offset` on and returns how many there were. Throws
  // Error{kInvalidArgument} when the disk fails.
  std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string name_;
  std::uint64_t size_ = 0;
  std::unique_ptr<std::FILE, Close> file_;
};

// Where what is not in memory of a file can be read, and how much of it at a time.
struct RestOfFile {
  const InputFile* file = nullptr;  // null: all is in memory
  std::size_t window_bytes = 0;
};

// The bytes of a file, the name to use in messages about it, and whom to ask whether to go on.
struct Input {
  std::span<const std::byte> bytes;  // all; or the first ones, and the header among them
  std::string_view name;
  const RunContext* context = nullptr;  // null: to the end, and nobody is told
  RestOfFile rest{};

  std::uint64_t size() const { return rest.file != nullptr ? rest.file->size() : bytes.size(); }

  // For the loops over what the file holds, with the turn's number: now and then, tells that the
  // first `at` bytes are done with, as the stage "read", and throws where the job shall stop.
  void tick(std::uint64_t turn, std::uint64_t at) const {
    constexpr std::uint64_t kTurns = 8192;  // a millisecond or two of parsing
    if (context != nullptr && turn % kTurns == 0) context->report("read", at, size());
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

// Throws Error{kResourceExhausted} without memory, what InputFile does and what `context.check`
// does. As short as the file, where somebody cuts it off meanwhile.
FileBytes read_front(const InputFile& file, std::uint64_t bytes, const RunContext& context);

// All of a file. Throws as InputFile and read_front.
FileBytes read_whole_file(const std::filesystem::path& path,
                          std::uint64_t max_bytes,
                          const RunContext& context = {});

}  // namespace landmarkdb
