#include "store/open.hpp"

#include <array>
#include <chrono>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "engine/base/error.hpp"
#include "store/output_file.hpp"

namespace landmarkdb {
namespace {

namespace fs = std::filesystem;
using sqlite::Database;
using sqlite::OpenMode;

constexpr std::string_view kMemory = ":memory:";
// Bytes a page. A choice: an array of megabytes is a chain of fewer pages than with SQLite's 4096.
constexpr int kPageBytes = 16384;
// The write-ahead log is cut back to this after a checkpoint.
constexpr std::int64_t kWalLimitBytes = std::int64_t{64} << 20U;

std::string quoted(const std::string& path) { return "'" + path + "'"; }

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::kInvalidArgument, quoted(path) + " " + why, "db");
}

// True for a file that exists and is not empty; throws for what can be no database.
//
// Looks at the file without opening it: closing any descriptor of a file drops all locks this
// process holds on it (POSIX), those of other SQLite connections too. What the file holds is for
// SQLite to say.
bool has_database(const std::string& path) {
  if (path.empty()) throw Error(ErrorCode::kInvalidArgument, "no database file is named", "db");
  if (path.find('\0') != std::string::npos) refuse(path, "has a zero byte in its name");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return false;
  if (status.type() == fs::file_type::none) {
    throw Error(error == std::errc::permission_denied ? ErrorCode::kPermissionDenied
                                                      : ErrorCode::kInvalidArgument,
                quoted(path) + ": " + error.message(),
                "db");
  }
  if (status.type() != fs::file_type::regular)
    refuse(path, "is no file, so no landmarkdb database");
  if (faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0) {
    throw Error(ErrorCode::kPermissionDenied, quoted(path) + " may not be read", "db");
  }
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) {
    throw Error(ErrorCode::kUnavailable, quoted(path) + ": " + error.message(), "db");
  }
  return bytes > 0;
}

// An SQLite file in which nothing has been made yet: what a kill during creation leaves.
bool is_blank(const Database& database) {
  return database.integer("PRAGMA application_id") == 0 && user_version(database) == 0 &&
         database.integer("SELECT count(*) FROM sqlite_schema") == 0;
}

void require_ours(const Database& database) {
  const std::int64_t id = database.integer("PRAGMA application_id");
  if (id != kApplicationId) {
    refuse(database.path(),
           "is not a landmarkdb database: it is an SQLite file with application id " +
               std::to_string(id) + ", want " + std::to_string(kApplicationId));
  }
}

[[noreturn]] void refuse_newer(const std::string& path, int version, int ours) {
  throw Error(ErrorCode::kUnimplemented,
              quoted(path) + " has database version " + std::to_string(version) +
                  ", this program reads " + std::to_string(ours) +
                  "; use the newer landmarkdb it was written with",
              "db");
}

void require_version(const Database& database) {
  require_ours(database);
  const int version = user_version(database);
  const int ours = latest_version(all_migrations());
  if (version > ours) refuse_newer(database.path(), version, ours);
  if (version < ours) {
    throw Error(ErrorCode::kUnimplemented,
                quoted(database.path()) + " has database version " + std::to_string(version) +
                    ", this program reads " + std::to_string(ours) +
                    "; bring it up to date with `landmarkdb-indexer --db " + database.path() +
                    " migrate`",
                "db");
  }
}

// Where two connections make one new file a WAL database at once, SQLite tells one of them "busy"
// without waiting, as waiting could deadlock: so the wait is here.
void switch_to_wal(const Database& database, std::chrono::milliseconds patience) {
  constexpr std::chrono::milliseconds kPause{5};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    try {
      database.execute("PRAGMA journal_mode = WAL");
      return;
    } catch (const Error& error) {
      const bool late = std::chrono::steady_clock::now() + kPause > deadline;
      if (error.code() != ErrorCode::kUnavailable || late) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

void prepare_for_writing(const Database& database, const StoreOptions& options) {
  switch_to_wal(database, options.busy_timeout);
  database.execute("PRAGMA synchronous = FULL");
  database.execute("PRAGMA journal_size_limit = " + std::to_string(kWalLimitBytes));
  if (options.max_bytes > 0) {
    const auto page = static_cast<std::uint64_t>(database.integer("PRAGMA page_size"));
    database.execute("PRAGMA max_page_count = " + std::to_string(options.max_bytes / page + 1));
  }
}

bool folder_may_be_written(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return access(folder.empty() ? "." : folder.c_str(), W_OK) == 0;
}

// A database in WAL mode needs its two companion files even to be read; where the folder does not
// allow them and no log is waiting, the file alone is the whole truth.
std::unique_ptr<Database> open_for_reading(const std::string& path, const StoreOptions& options) {
  auto database = std::make_unique<Database>(path, OpenMode::kReadOnly, options.busy_timeout);
  try {
    database->integer("SELECT count(*) FROM sqlite_schema");
    return database;
  } catch (const Error&) {
    std::error_code missing;
    const auto wal_bytes = fs::file_size(path + "-wal", missing);
    const bool log_waits = !missing && wal_bytes > 0;
    if (folder_may_be_written(path) || log_waits) throw;
    return std::make_unique<Database>(path, OpenMode::kImmutable, options.busy_timeout);
  }
}

std::string free_backup_path(const std::string& path, int version) {
  const std::string base = path + ".v" + std::to_string(version) + ".backup";
  std::string candidate = base;
  std::error_code ignored;  // what cannot be looked at cannot be written either, which will be said
  for (int i = 2; fs::exists(candidate, ignored); ++i) candidate = base + "-" + std::to_string(i);
  return candidate;
}

}  // namespace

std::unique_ptr<Database> create_or_open_database(const std::string& path,
                                                  const StoreOptions& options) {
  const bool memory = path == kMemory;
  if (!memory && has_database(path)) {
    auto database = std::make_unique<Database>(path, OpenMode::kReadWrite, options.busy_timeout);
    if (!is_blank(*database)) {
      require_version(*database);
      prepare_for_writing(*database, options);
      return database;
    }
  }
  auto database = std::make_unique<Database>(path, OpenMode::kCreate, options.busy_timeout);
  database->execute("PRAGMA page_size = " + std::to_string(kPageBytes));
  prepare_for_writing(*database, options);
  create_schema(*database, all_migrations());
  require_version(*database);
  return database;
}

std::unique_ptr<Database> open_database(const std::string& path,
                                        bool read_only,
                                        const StoreOptions& options) {
  if (!has_database(path)) {
    refuse(path, "does not exist or is empty; `landmarkdb-indexer --db FILE add` makes a database");
  }
  auto database =
      read_only ? open_for_reading(path, options)
                : std::make_unique<Database>(path, OpenMode::kReadWrite, options.busy_timeout);
  require_version(*database);
  if (!read_only) prepare_for_writing(*database, options);
  return database;
}

MigrationReport migrate_database(const std::string& path,
                                 bool dry_run,
                                 std::span<const Migration> migrations,
                                 const RunContext& context) {
  if (!has_database(path)) refuse(path, "does not exist or is empty; there is nothing to migrate");
  MigrationReport report;
  report.to_version = latest_version(migrations);
  const StoreOptions options;
  const auto database =
      dry_run ? open_for_reading(path, options)
              : std::make_unique<Database>(path, OpenMode::kReadWrite, options.busy_timeout);
  require_ours(*database);
  report.from_version = user_version(*database);
  if (report.from_version > report.to_version) {
    refuse_newer(path, report.from_version, report.to_version);
  }
  report.steps = pending_migrations(report.from_version, migrations);
  if (dry_run || report.steps.empty()) return report;
  report.backup_path = free_backup_path(path, report.from_version);
  backup_database(*database, report.backup_path, context);
  prepare_for_writing(*database, options);
  report.steps = apply_migrations(*database, migrations);
  return report;
}

std::vector<std::string> location_warnings(const Database& database) {
  // From linux/magic.h and the file systems' own sources.
  static constexpr std::array<std::pair<std::uint32_t, std::string_view>, 8> kNetworkFileSystems{
      {{0x6969U, "NFS"},
       {0x517bU, "SMB"},
       {0xff534d42U, "CIFS"},
       {0xfe534d42U, "SMB2"},
       {0x01021997U, "9P"},
       {0x00c36400U, "Ceph"},
       {0x0bd00bd0U, "Lustre"},
       {0x5346414fU, "AFS"}}};
  const std::string& path = database.path();
  std::vector<std::string> warnings;
  if (database.mode() == OpenMode::kImmutable) {
    warnings.push_back(quoted(path) +
                       " lies in a folder that may not be written, so changes by other processes "
                       "are not seen: open it again after one");
  }
  struct statfs info {};
  if (path == kMemory || statfs(path.c_str(), &info) != 0) return warnings;
  for (const auto& [magic, name] : kNetworkFileSystems) {
    if (static_cast<std::uint32_t>(info.f_type) == magic) {
      warnings.push_back(quoted(path) + " lies on a network file system (" + std::string(name) +
                         "), where file locks cannot be relied upon: use it from one machine at a "
                         "time, or better keep it on a local disk");
    }
  }
  return warnings;
}

}  // namespace landmarkdb
