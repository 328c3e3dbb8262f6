#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "store/sqlite.hpp"

namespace landmarkdb {

// One file of schema/: brings a database from version - 1 to `version`.
struct Migration {
  int version;
  std::string_view name;  // "0001_initial"
  std::string_view sql;
};

// All of schema/, ascending from version 1 without gaps.
std::span<const Migration> all_migrations();

// In the file's header; "lmdk" in ASCII.
inline constexpr std::int64_t kApplicationId = 0x6c6d646b;

// PRAGMA user_version: the last migration that was applied.
int user_version(const sqlite::Database& database);
int latest_version(std::span<const Migration> migrations);

// The migrations a database of `version` still lacks, by name.
std::vector<std::string> pending_migrations(int version, std::span<const Migration> migrations);

// Brings a new database to the last version in one transaction: nobody ever sees one of an older
// version that nobody made, also where two make it at once or one is killed on the way.
void create_schema(const sqlite::Database& database, std::span<const Migration> migrations);

// Applies what is missing, in order, each in one transaction together with its version number. A
// failing one leaves the database at the version before it. Returns the names of those applied.
std::vector<std::string> apply_migrations(const sqlite::Database& database,
                                          std::span<const Migration> migrations);

}  // namespace landmarkdb
