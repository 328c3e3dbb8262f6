#pragma once

#include <functional>
#include <string>

#include "engine/base/run_context.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// Makes the file `path`, which must not exist, whole or not at all: `write` fills a temporary file
// beside it (whose path it is given), which is then synced and takes its name. Throws
// Error{kAlreadyExists} when there is something at `path`, before and after the writing.
void write_new_file(const std::string& path, const std::function<void(const std::string&)>& write);

// Copies the database, as it is at one moment, to the new file `path`. Reports the stage "backup"
// in bytes.
void backup_database(const sqlite::Database& database,
                     const std::string& path,
                     const RunContext& context);

}  // namespace landmarkdb
