#include "engine/cloud/input.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include <sys/stat.h>

#include "engine/base/error.hpp"

namespace landmarkdb {

void refuse(const Input& input, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, std::string(input.name) + ": " + what);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = "\"";
  for (const char c : text.substr(0, kLongest)) shown += (c >= ' ' && c <= '~') ? c : '?';
  return shown + (text.size() > kLongest ? "...\"" : "\"");
}

void check_count(const Input& input,
                 std::uint64_t count,
                 std::uint64_t bytes_each,
                 std::uint64_t available,
                 std::uint64_t max_count,
                 std::string_view what) {
  if (count > available / std::max<std::uint64_t>(bytes_each, 1)) {
    refuse(input,
           "the header promises " + std::to_string(count) + " " + std::string(what) +
               " of at least " + std::to_string(bytes_each) + " bytes, but only " +
               std::to_string(available) + " bytes follow (truncated file?)");
  }
  if (count > max_count) {
    refuse(input,
           std::to_string(count) + " " + std::string(what) + ", want at most " +
               std::to_string(max_count));
  }
}

FileBytes read_whole_file(const std::filesystem::path& path,
                          std::uint64_t max_bytes,
                          const RunContext& context) {
  const std::string name = path.string();
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct stat info {};
  if (::stat(name.c_str(), &info) != 0) {
    throw Error(ErrorCode::kInvalidArgument, name + ": cannot be read: " + std::strerror(errno));
  }
  if (!S_ISREG(info.st_mode)) {
    throw Error(ErrorCode::kInvalidArgument, name + ": is not a regular file");
  }
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(name.c_str(), "rb"));
  if (!file) {
    throw Error(ErrorCode::kInvalidArgument, name + ": cannot be read: " + std::strerror(errno));
  }
  const auto size = static_cast<std::uint64_t>(info.st_size);
  if (size > max_bytes) {
    throw Error(ErrorCode::kInvalidArgument,
                name + ": has " + std::to_string(size) + " bytes, want at most " +
                    std::to_string(max_bytes));
  }
  FileBytes bytes;
  try {
    bytes.data = std::make_unique_for_overwrite<std::byte[]>(size);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kResourceExhausted,
                name + ": no memory for its " + std::to_string(size) + " bytes");
  }
  constexpr std::size_t kChunk = std::size_t{16} * 1024 * 1024;  // a tenth of a second of a disk
  while (bytes.size < size) {
    context.check("read");
    const std::size_t wanted = std::min<std::size_t>(kChunk, size - bytes.size);
    const std::size_t got = std::fread(bytes.data.get() + bytes.size, 1, wanted, file.get());
    bytes.size += got;
    if (got < wanted) break;
  }
  if (bytes.size != size && std::ferror(file.get()) != 0) {
    throw Error(ErrorCode::kInvalidArgument, name + ": cannot be read: " + std::strerror(errno));
  }
  return bytes;
}

}  // namespace landmarkdb
