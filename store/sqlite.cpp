#include "store/sqlite.hpp"

#include <cassert>
#include <thread>

#include <sqlite3.h>

#include "engine/base/error.hpp"
#include "store/sqlite_error.hpp"
#include "store/utf8.hpp"

namespace landmarkdb::sqlite {
namespace {

int open_flags(OpenMode mode) {
  switch (mode) {
    case OpenMode::kReadOnly:
      return SQLITE_OPEN_READONLY;
    case OpenMode::kImmutable:
      return SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    case OpenMode::kReadWrite:
      return SQLITE_OPEN_READWRITE;
    case OpenMode::kCreate:
      return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  }
  return SQLITE_OPEN_READONLY;
}

// "immutable" can only be asked for through a URI; all but plain characters are escaped.
std::string immutable_uri(const std::string& path) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string uri = "file:";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '.' || c == '_' || c == '-';
    if (plain) {
      uri += c;
    } else {
      uri += '%';
      uri += kHex[byte >> 4U];
      uri += kHex[byte & 0xfU];
    }
  }
  return uri + "?immutable=1";
}

// Nobody asks how much memory SQLite takes, and counting it has every thread wait for one lock: a
// thousand scenes are read in three quarters of the time without.
void count_no_memory() {
  [[maybe_unused]] static const int code = sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
}

}  // namespace

Database::Database(const std::string& path, OpenMode mode, std::chrono::milliseconds busy_timeout)
    : path_(path), mode_(mode) {
  // SQLite gives some names a meaning of their own; ":memory:" is the one we want.
  const std::string plain =
      !path.empty() && path.front() == ':' && path != ":memory:" ? "./" + path : path;
  const std::string name = mode == OpenMode::kImmutable ? immutable_uri(plain) : plain;
  count_no_memory();
  const int code = sqlite3_open_v2(name.c_str(), &handle_, open_flags(mode), nullptr);
  try {
    if (code != SQLITE_OK) throw_error(handle_, code, path_);
    sqlite3_extended_result_codes(handle_, 1);
    sqlite3_busy_timeout(handle_, static_cast<int>(busy_timeout.count()));
    // A file may come from anywhere: its schema must not be able to run anything surprising.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    execute("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA foreign_keys = ON");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

Database::~Database() {
  const int code = sqlite3_close(handle_);
  assert(code == SQLITE_OK && "a statement outlives its database");
  static_cast<void>(code);
}

void Database::execute(const std::string& sql) const {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw_error(handle_, code, path_);
}

std::int64_t Database::integer(const std::string& sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::int64_t Database::last_insert_id() const { return sqlite3_last_insert_rowid(handle_); }
std::int64_t Database::changed_rows() const { return sqlite3_changes64(handle_); }
bool Database::in_transaction() const { return sqlite3_get_autocommit(handle_) == 0; }

Statement::Statement(const Database& database, std::string_view sql) : database_(database) {
  check(sqlite3_prepare_v2(
      database.handle(), sql.data(), static_cast<int>(sql.size()), &statement_, nullptr));
}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::check(int code) const {
  if (code != SQLITE_OK) throw_error(database_.handle(), code, database_.path());
}

Statement& Statement::bind(std::int64_t value) {
  check(sqlite3_bind_int64(statement_, ++bound_, value));
  return *this;
}

Statement& Statement::bind(double value) {
  check(sqlite3_bind_double(statement_, ++bound_, value));
  return *this;
}

Statement& Statement::bind(std::string_view text) {
  // A null pointer would bind NULL.
  check(sqlite3_bind_text64(statement_,
                            ++bound_,
                            text.data() != nullptr ? text.data() : "",
                            text.size(),
                            SQLITE_STATIC,
                            SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(std::span<const std::byte> blob) {
  if (blob.empty()) {
    check(sqlite3_bind_zeroblob(statement_, ++bound_, 0));
  } else {
    check(sqlite3_bind_blob64(statement_, ++bound_, blob.data(), blob.size(), SQLITE_STATIC));
  }
  return *this;
}

Statement& Statement::bind_null() {
  check(sqlite3_bind_null(statement_, ++bound_));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  throw_error(database_.handle(), code, database_.path());
}

void Statement::run() {
  while (step()) {
  }
  check(sqlite3_reset(statement_));
  check(sqlite3_clear_bindings(statement_));
  bound_ = 0;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

double Statement::real(int column) const { return sqlite3_column_double(statement_, column); }

std::string Statement::text(int column) const {
  const unsigned char* data = sqlite3_column_text(statement_, column);
  if (data == nullptr) return {};
  return valid_utf8({reinterpret_cast<const char*>(data),
                     static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))});
}

std::span<const std::byte> Statement::blob(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  // Null is "empty", but also how a failed read of the blob's pages or a lack of memory shows.
  if (data == nullptr && size != 0) check(sqlite3_errcode(database_.handle()));
  if (data == nullptr) return {};
  return {static_cast<const std::byte*>(data), static_cast<std::size_t>(size)};
}

Transaction::Transaction(const Database& database, Kind kind) : database_(database) {
  database_.execute(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN");
}

Transaction::~Transaction() {
  // SQLite may have rolled back by itself (a full disk); a failure here leaves nothing to do.
  if (open_ && database_.in_transaction()) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

InterruptGuard::InterruptGuard(const Database& database, const RunContext& context)
    : database_(database) {
  static constexpr int kInstructionsBetweenLooks = 10'000;  // well below a millisecond
  sqlite3_progress_handler(
      database.handle(),
      kInstructionsBetweenLooks,
      [](void* user) { return static_cast<const RunContext*>(user)->should_stop() ? 1 : 0; },
      const_cast<RunContext*>(&context));
}

InterruptGuard::~InterruptGuard() {
  sqlite3_progress_handler(database_.handle(), 0, nullptr, nullptr);
}

void copy_database(const Database& from,
                   const Database& to,
                   const std::function<void(std::uint64_t, std::uint64_t)>& on_pages) {
  static constexpr int kPagesAtOnce = 1024;
  static constexpr int kMaxBusyRounds = 500;
  static constexpr std::chrono::milliseconds kBusyPause{10};
  // A read transaction of our own holds one moment of `from`: without it, each write by another
  // connection would make the copy start again.
  const Transaction snapshot(from, Transaction::Kind::kRead);
  from.integer("SELECT count(*) FROM sqlite_schema");
  const std::unique_ptr<sqlite3_backup, int (*)(sqlite3_backup*)> backup(
      sqlite3_backup_init(to.handle(), "main", from.handle(), "main"), &sqlite3_backup_finish);
  if (!backup) throw_error(to.handle(), sqlite3_errcode(to.handle()), to.path());
  int busy_rounds = 0;
  for (;;) {
    const int code = sqlite3_backup_step(backup.get(), kPagesAtOnce);
    const auto total = static_cast<std::uint64_t>(sqlite3_backup_pagecount(backup.get()));
    const auto left = static_cast<std::uint64_t>(sqlite3_backup_remaining(backup.get()));
    if (code == SQLITE_DONE) {
      on_pages(total, total);
      return;
    }
    if (code == SQLITE_BUSY || code == SQLITE_LOCKED) {
      if (++busy_rounds > kMaxBusyRounds) throw_error(nullptr, code, from.path());
      std::this_thread::sleep_for(kBusyPause);
    } else if (code != SQLITE_OK) {
      throw_error(to.handle(), code, to.path());
    }
    on_pages(total - left, total);
  }
}

}  // namespace landmarkdb::sqlite
