#include "cli/write_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::cli {
namespace {

// Returns 0 or the errno of what failed.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int write_to(const std::string& path, int flags, std::string_view bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | flags, 0666);
  if (descriptor < 0) return errno;
  const int failed = write_all(descriptor, bytes);
  const int closing = ::close(descriptor) == 0 ? 0 : errno;
  return failed != 0 ? failed : closing;
}

int replace(const std::string& path, const struct stat* before, std::string_view bytes) {
  // The process's number: two that write one file do not meet in the draft.
  const std::string draft = path + "." + std::to_string(::getpid()) + ".new";
  int failed = write_to(draft, O_CREAT | O_TRUNC | O_NOFOLLOW, bytes);
  if (failed == 0 && before != nullptr && ::chmod(draft.c_str(), before->st_mode & 07777U) != 0) {
    failed = errno;
  }
  if (failed == 0 && std::rename(draft.c_str(), path.c_str()) != 0) failed = errno;
  if (failed != 0) ::unlink(draft.c_str());
  return failed;
}

}  // namespace

void write_file(const std::filesystem::path& path,
                std::string_view bytes,
                const std::string& option) {
  struct stat info {};
  const bool there = ::lstat(path.c_str(), &info) == 0;
  const int failed = there && !S_ISREG(info.st_mode)
                         ? write_to(path.string(), O_TRUNC, bytes)
                         : replace(path.string(), there ? &info : nullptr, bytes);
  if (failed == 0) return;
  throw Error(ErrorCode::kResourceExhausted,
              path.string() + ": cannot be written: " + std::strerror(failed),
              option);
}

}  // namespace landmarkdb::cli
