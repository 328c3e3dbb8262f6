#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/migrations.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// The three ways Store opens a file; see there.
std::unique_ptr<sqlite::Database> create_or_open_database(const std::string& path,
                                                          const StoreOptions& options);
std::unique_ptr<sqlite::Database> open_database(const std::string& path,
                                                bool read_only,
                                                const StoreOptions& options);

// Store::migrate, for any list of migrations.
MigrationReport migrate_database(const std::string& path,
                                 bool dry_run,
                                 std::span<const Migration> migrations,
                                 const RunContext& context);

// Sentences about where the file lies: a network file system, whose locks cannot be relied upon; a
// folder in which changes by others cannot be seen.
std::vector<std::string> location_warnings(const sqlite::Database& database);

}  // namespace landmarkdb
