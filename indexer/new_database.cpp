#include "indexer/new_database.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "engine/base/error.hpp"
#include "store/output_file.hpp"

namespace landmarkdb::indexer {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// True where there is nothing yet, or an empty file: SQLite makes a database of either.
bool is_vacant(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return !error;
  return fs::is_regular_file(path, error) && fs::file_size(path, error) == 0 && !error;
}

void remove_database(const std::string& path) {
  constexpr std::array kSuffixes = {"", "-wal", "-shm", "-journal"};  // SQLite's companions
  std::error_code ignored;
  for (const char* suffix : kSuffixes) fs::remove(path + suffix, ignored);
}

// Removes the file under construction, whatever way its maker is left.
struct Scaffold {
  std::string path;
  ~Scaffold() { remove_database(path); }
};

void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

// A new database at `path`, all of it in the one file: its name is all that will be moved.
InsertResult build(const std::string& path, const std::function<InsertResult(Store&)>& change) {
  InsertResult result;
  {
    Store store = Store::create_or_open(path);
    result = change(store);
    store.checkpoint();
  }
  std::error_code missing;
  const std::uintmax_t log_bytes = fs::file_size(path + "-wal", missing);
  if (!missing && log_bytes > 0) {
    throw Error(ErrorCode::kUnavailable,
                path + ": the new database is not whole: its log holds " +
                    std::to_string(log_bytes) + " bytes");
  }
  return result;
}

}  // namespace

void require_writable_database(const std::string& path) {
  if (!is_vacant(path)) {
    Store::open_read_write(path);
    return;
  }
  const fs::path folder = folder_of(path);
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error(ErrorCode::kInvalidArgument,
                path + ": there is no folder " + folder.string() + " to put the database in");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw Error(ErrorCode::kPermissionDenied,
                path + ": the folder " + folder.string() + " cannot be written to");
  }
  if (fs::exists(path, error) && ::access(path.c_str(), W_OK) != 0) {
    throw Error(ErrorCode::kPermissionDenied, path + " cannot be written to");
  }
}

InsertResult change_or_create(const std::string& path,
                              const std::function<InsertResult(Store&)>& change) {
  if (is_vacant(path)) {
    const Scaffold scaffold{path + ".new-" + std::to_string(::getpid())};
    remove_database(scaffold.path);
    const InsertResult result = build(scaffold.path, change);
    if (take_name(scaffold.path, path)) {
      sync_folder(folder_of(path));
      return result;
    }
  }
  // Someone else's database, or an empty file that is not ours to replace.
  Store store = Store::create_or_open(path);
  return change(store);
}

}  // namespace landmarkdb::indexer
