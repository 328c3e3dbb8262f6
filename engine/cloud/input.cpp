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

InputFile::InputFile(const std::filesystem::path& path, std::uint64_t max_bytes)
    : name_(path.string()) {
  struct stat info {};
  if (::stat(name_.c_str(), &info) != 0) {
    throw Error(ErrorCode::kInvalidArgument, name_ + ": cannot be read: " + std::strerror(errno));
  }
  if (!S_ISREG(info.st_mode)) {
    throw Error(ErrorCode::kInvalidArgument, name_ + ": is not a regular file");
  }
  file_.reset(std::fopen(name_.c_str(), "rb"));
  if (!file_) {
    throw Error(ErrorCode::kInvalidArgument, name_ + ": cannot be read: " + std::strerror(errno));
  }
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // it is read in large pieces
  size_ = static_cast<std::uint64_t>(info.st_size);
  if (size_ > max_bytes) {
    throw Error(ErrorCode::kInvalidArgument,
                name_ + ": has " + std::to_string(size_) + " bytes, want at most " +
                    std::to_string(max_bytes));
  }
}

std::size_t InputFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  const bool there = ::fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) == 0;
  const std::size_t got = there ? std::fread(to.data(), 1, to.size(), file_.get()) : 0;
  if (!there || (got < to.size() && std::ferror(file_.get()) != 0)) {
    throw Error(ErrorCode::kInvalidArgument, name_ + ": cannot be read: " + std::strerror(errno));
  }
  return got;
}

FileBytes read_front(const InputFile& file, std::uint64_t bytes, const RunContext& context) {
  FileBytes front;
  const auto size = static_cast<std::size_t>(std::min(bytes, file.size()));
  try {
    front.data = std::make_unique_for_overwrite<std::byte[]>(size);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::kResourceExhausted,
                file.name() + ": no memory for its " + std::to_string(size) + " bytes");
  }
  constexpr std::size_t kChunk = std::size_t{16} * 1024 * 1024;  // a tenth of a second of a disk
  while (front.size < size) {
    context.check("read");
    const std::size_t wanted = std::min<std::size_t>(kChunk, size - front.size);
    const std::size_t got = file.read(front.size, {front.data.get() + front.size, wanted});
    front.size += got;
    if (got < wanted) break;
  }
  return front;
}

FileBytes read_whole_file(const std::filesystem::path& path,
                          std::uint64_t max_bytes,
                          const RunContext& context) {
  const InputFile file(path, max_bytes);
  return read_front(file, file.size(), context);
}

}  // namespace landmarkdb
