#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "store/open.hpp"
#include "store/sqlite.hpp"
#include "store/store.hpp"

namespace landmarkdb {

// What an open Store holds; for store.cpp and store_models.cpp.
struct Store::State {
  std::unique_ptr<sqlite::Database> database;
  bool read_only = false;
  std::vector<std::string> warnings;

  State(std::unique_ptr<sqlite::Database> opened, bool for_reading)
      : database(std::move(opened)),
        read_only(for_reading),
        warnings(location_warnings(*database)) {}

  const sqlite::Database& reader() const { return *database; }
  const sqlite::Database& writer() const {
    if (read_only) {
      throw Error(ErrorCode::kPermissionDenied,
                  "'" + database->path() + "' was opened for reading only");
    }
    return *database;
  }
  sqlite::Transaction snapshot() const {
    return sqlite::Transaction(*database, sqlite::Transaction::Kind::kRead);
  }
};

}  // namespace landmarkdb
