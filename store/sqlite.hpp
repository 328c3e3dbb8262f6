#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/run_context.hpp"

struct sqlite3;
struct sqlite3_stmt;

// The part of SQLite that the store uses. Every result code that is not success becomes an Error
// that names the file (see sqlite_error.hpp). Nothing here is thread-safe.
namespace landmarkdb::sqlite {

enum class OpenMode {
  kReadOnly,
  kImmutable,  // read-only without looking for other processes: for a folder we may not write to
  kReadWrite,
  kCreate,  // read-write, made where there is none
};

class Database {
 public:
  Database(const std::string& path, OpenMode mode, std::chrono::milliseconds busy_timeout);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Runs one or more statements and ignores rows they give.
  void execute(const std::string& sql) const;
  // The first column of the first row; 0 where there is no row.
  std::int64_t integer(const std::string& sql) const;

  std::int64_t last_insert_id() const;
  std::int64_t changed_rows() const;  // by the last statement that changed rows
  bool in_transaction() const;

  const std::string& path() const { return path_; }
  OpenMode mode() const { return mode_; }
  sqlite3* handle() const { return handle_; }

 private:
  std::string path_;
  OpenMode mode_;
  sqlite3* handle_ = nullptr;
};

// A prepared statement; it must not outlive its database. Parameters are bound from left to right;
// texts and blobs are not copied and must live until the statement is reset or destroyed.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::int64_t value);
  Statement& bind(double value);
  Statement& bind(std::string_view text);
  Statement& bind(std::span<const std::byte> blob);
  Statement& bind_null();

  // True: a row is there to be read. False: done.
  bool step();
  // Steps to the end and makes the statement ready to be bound again.
  void run();

  // Columns of the current row, from 0. Views are valid until the next step.
  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;  // valid UTF-8, whatever the file holds
  std::span<const std::byte> blob(int column) const;

 private:
  void check(int code) const;

  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

// Rolled back unless committed. A read transaction sees one moment of the database.
class Transaction {
 public:
  enum class Kind { kRead, kWrite };
  Transaction(const Database& database, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

// While it lives, statements of the database stop once `context` should stop; they then throw
// Error{kCancelled}. Both must outlive it.
class InterruptGuard {
 public:
  InterruptGuard(const Database& database, const RunContext& context);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  const Database& database_;
};

// Copies the whole of `from` over `to`, as it is at one moment. `on_pages(done, total)` is called
// now and then and may throw.
void copy_database(const Database& from,
                   const Database& to,
                   const std::function<void(std::uint64_t, std::uint64_t)>& on_pages);

}  // namespace landmarkdb::sqlite
