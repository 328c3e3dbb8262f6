#include "store/output_file.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBusyTimeout{5000};
constexpr mode_t kPermissions = 0777;

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

// An empty file beside `path` that is this writer's alone, removed when the writing ends.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, std::optional<mode_t> mode) {
    static constexpr int kMaxTries = 100;  // names left behind by killed processes of this id
    int descriptor = -1;
    for (int i = 0; i < kMaxTries && descriptor < 0; ++i) {
      path_ = path + ".partial-" + std::to_string(getpid()) + "-" + std::to_string(i);
      descriptor =
          open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kNewFileMode);
      if (descriptor < 0 && errno != EEXIST) fail(path, errno);
    }
    if (descriptor < 0) fail(path, EEXIST);
    const int error = mode && fchmod(descriptor, *mode) != 0 ? errno : 0;
    close(descriptor);
    if (error == 0) return;
    unlink(path_.c_str());
    fail(path, error);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(path_ + suffix, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  static constexpr mode_t kNewFileMode = 0666;  // less what the umask takes
  std::string path_;
};

// True for the errors by which a file system says that it does not know an operation.
bool is_unsupported(int system_error) {
  return system_error == EPERM || system_error == ENOTSUP || system_error == EINVAL ||
         system_error == ENOSYS;
}

}  // namespace

bool take_name(const std::string& from, const std::string& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno == EEXIST) return false;
  if (!is_unsupported(errno)) fail(to, errno);
  // A hard link does not replace either.
  if (link(from.c_str(), to.c_str()) == 0) return true;
  if (errno == EEXIST) return false;
  fail(to, errno);
}

void write_new_file(const std::string& path,
                    const std::function<void(const std::string&)>& write,
                    std::optional<mode_t> mode) {
  if (path.empty() || path.find('\0') != std::string::npos) fail(path, ENOENT);
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error))) refuse_existing(path);
  fs::path folder = fs::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (!fs::is_directory(folder, error)) fail(path, ENOENT);
  const TemporaryFile temporary(path, mode);
  write(temporary.path());
  sync_to_disk(temporary.path(), O_RDONLY);
  if (!take_name(temporary.path(), path)) refuse_existing(path);
  sync_to_disk(folder.string(), O_RDONLY | O_DIRECTORY);
}

void backup_database(const sqlite::Database& database,
                     const std::string& path,
                     const RunContext& context) {
  struct stat source {};
  std::optional<mode_t> mode;
  if (stat(database.path().c_str(), &source) == 0) mode = source.st_mode & kPermissions;
  const auto write = [&](const std::string& temporary) {
    const sqlite::Database copy(temporary, sqlite::OpenMode::kCreate, kBusyTimeout);
    // Synced once at the end, and thrown away if that is not reached.
    copy.execute("PRAGMA synchronous = OFF");
    const auto page = static_cast<std::uint64_t>(database.integer("PRAGMA page_size"));
    sqlite::copy_database(database, copy, [&](std::uint64_t done, std::uint64_t total) {
      context.report("backup", done * page, total * page);
    });
  };
  // SQLite has to write the copy, whatever the source's owner may.
  write_new_file(path, write, mode ? std::optional<mode_t>(*mode | S_IRUSR | S_IWUSR) : mode);
}

}  // namespace landmarkdb
