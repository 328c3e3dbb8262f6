#include "indexer/new_database.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::indexer {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

bool exists(const std::string& path) {
  std::error_code error;
  return fs::exists(path, error);
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

// Gives the file `from` the name `to`; false when that name is taken by now.
bool take_name(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno == EEXIST) return false;
  // A file system that does not know the flag: a hard link does not replace either.
  if (::link(from.c_str(), to.c_str()) == 0) return true;
  if (errno == EEXIST) return false;
  throw Error(ErrorCode::kResourceExhausted,
              to + ": the new database cannot be put in place: " + std::strerror(errno));
}

void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void require_writable_database(const std::string& path) {
  if (exists(path)) {
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
}

InsertResult change_or_create(const std::string& path,
                              const std::function<InsertResult(Store&)>& change) {
  if (!exists(path)) {
    const Scaffold scaffold{path + ".new-" + std::to_string(::getpid())};
    remove_database(scaffold.path);
    InsertResult result;
    {
      Store store = Store::create_or_open(scaffold.path);
      result = change(store);
    }
    if (take_name(scaffold.path, path)) {
      sync_folder(folder_of(path));
      return result;
    }
  }
  Store store = Store::open_read_write(path);
  return change(store);
}

}  // namespace landmarkdb::indexer
