#include "store/sqlite_error.hpp"

#include <cerrno>
#include <cstring>

#include <sqlite3.h>

#include "engine/base/error.hpp"

namespace landmarkdb::sqlite {
namespace {

Error io_error(int system_error, const std::string& quoted, const std::string& detail) {
  switch (system_error) {
    case ENOSPC:
    case EDQUOT:
      return Error(ErrorCode::kResourceExhausted,
                   "the disk is full: " + quoted + " could not grow; nothing was changed");
    case EFBIG:
      return Error(ErrorCode::kResourceExhausted,
                   quoted + " would grow past the largest file allowed; nothing was changed");
    case EACCES:
    case EPERM:
    case EROFS:
      return Error(ErrorCode::kPermissionDenied,
                   quoted + ": not permitted (" + std::strerror(system_error) + ")");
    default:
      return Error(ErrorCode::kUnavailable,
                   "reading or writing " + quoted + " failed: " + detail +
                       (system_error != 0 ? std::string(" (") + std::strerror(system_error) + ")"
                                          : std::string()));
  }
}

}  // namespace

void throw_error(sqlite3* handle, int code, const std::string& path) {
  const std::string quoted = "'" + path + "'";
  const std::string detail = handle != nullptr ? sqlite3_errmsg(handle) : sqlite3_errstr(code);
  const int system_error = handle != nullptr ? sqlite3_system_errno(handle) : 0;
  switch (code & 0xff) {  // the primary code; the rest says more of the same
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw Error(ErrorCode::kUnavailable,
                  "another process is writing to " + quoted + "; try again when it is done");
    case SQLITE_FULL:
      throw Error(ErrorCode::kResourceExhausted,
                  "the disk is full, or the database's size limit is reached: " + quoted +
                      " could not grow; nothing was changed");
    case SQLITE_NOMEM:
    case SQLITE_TOOBIG:
      throw Error(ErrorCode::kResourceExhausted, quoted + ": " + detail);
    case SQLITE_CORRUPT:
      throw Error(ErrorCode::kDataLoss,
                  quoted + " is damaged (" + detail + "); `check` says what is affected");
    case SQLITE_NOTADB:
      throw Error(ErrorCode::kInvalidArgument,
                  quoted + " is not a landmarkdb database: it is no SQLite file");
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      throw Error(ErrorCode::kPermissionDenied, quoted + " cannot be written: " + detail);
    case SQLITE_CANTOPEN:
      if (system_error == EACCES || system_error == EPERM || system_error == EROFS) {
        throw io_error(system_error, quoted, detail);
      }
      throw Error(ErrorCode::kUnavailable,
                  quoted + " cannot be opened" +
                      (system_error != 0 ? std::string(": ") + std::strerror(system_error)
                                         : std::string()));
    case SQLITE_IOERR:
      throw io_error(system_error, quoted, detail);
    case SQLITE_INTERRUPT:
      throw Error(ErrorCode::kCancelled, "stopped on request");
    default:
      throw Error(ErrorCode::kInternal, quoted + ": " + detail);
  }
}

}  // namespace landmarkdb::sqlite
