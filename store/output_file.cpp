#include "store/output_file.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBusyTimeout{5000};

[[noreturn]] void fail(const std::string& path, int system_error) {
  ErrorCode code = ErrorCode::kUnavailable;
  if (system_error == ENOSPC || system_error == EDQUOT || system_error == EFBIG) {
    code = ErrorCode::kResourceExhausted;
  } else if (system_error == EACCES || system_error == EPERM || system_error == EROFS) {
    code = ErrorCode::kPermissionDenied;
  } else if (system_error == ENOENT || system_error == ENOTDIR || system_error == EISDIR ||
             system_error == ENAMETOOLONG) {
    code = ErrorCode::kInvalidArgument;
  }
  throw Error(code, "'" + path + "' cannot be written: " + std::strerror(system_error));
}

[[noreturn]] void refuse_existing(const std::string& path) {
  throw Error(ErrorCode::kAlreadyExists,
              "there is already a file '" + path + "'; it was not touched");
}

void sync_to_disk(const std::string& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) fail(path, errno);
  const int result = fsync(descriptor);
  const int error = errno;
  close(descriptor);
  if (result != 0) fail(path, error);
}

// Removes the temporary file when the writing ends early.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(path_ + suffix, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

void write_new_file(const std::string& path, const std::function<void(const std::string&)>& write) {
  if (path.empty() || path.find('\0') != std::string::npos) fail(path, ENOENT);
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) refuse_existing(path);
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (!fs::is_directory(folder, error)) fail(path, ENOENT);
  const TemporaryFile temporary(path + ".partial-" + std::to_string(getpid()));
  write(temporary.path());
  sync_to_disk(temporary.path(), O_RDONLY);
  // A hard link takes the name only if it is free; some file systems have none, then a rename does.
  if (link(temporary.path().c_str(), path.c_str()) != 0) {
    if (errno == EEXIST) refuse_existing(path);
    if (std::rename(temporary.path().c_str(), path.c_str()) != 0) fail(path, errno);
  }
  sync_to_disk(folder.string(), O_RDONLY | O_DIRECTORY);
}

void backup_database(const sqlite::Database& database,
                     const std::string& path,
                     const RunContext& context) {
  write_new_file(path, [&](const std::string& temporary) {
    const sqlite::Database copy(temporary, sqlite::OpenMode::kCreate, kBusyTimeout);
    // Synced once at the end, and thrown away if that is not reached.
    copy.execute("PRAGMA synchronous = OFF");
    const auto page = static_cast<std::uint64_t>(database.integer("PRAGMA page_size"));
    sqlite::copy_database(database, copy, [&](std::uint64_t done, std::uint64_t total) {
      context.report("backup", done * page, total * page);
    });
  });
}

}  // namespace landmarkdb
