#pragma once

#include <string>

struct sqlite3;

namespace landmarkdb::sqlite {

// Throws the Error for a SQLite result code: a busy file is kUnavailable, a full disk
// kResourceExhausted, a damaged file kDataLoss, no database at all kInvalidArgument, no permission
// kPermissionDenied, an interrupted statement kCancelled. `handle` may be null.
[[noreturn]] void throw_error(sqlite3* handle, int code, const std::string& path);

}  // namespace landmarkdb::sqlite
