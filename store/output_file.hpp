#pragma once

#include <functional>
#include <optional>
#include <string>

#include <sys/types.h>

#include "engine/base/run_context.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// Makes the file `path`, which must not exist, whole or not at all: `write` fills a temporary file
// beside it (whose path it is given), which is then synced and takes its name. Throws
// Error{kAlreadyExists} when there is something at `path`, before and after the writing. The file
// gets the permissions `mode`, or what the process gives to new files.
void write_new_file(const std::string& path,
                    const std::function<void(const std::string&)>& write,
                    std::optional<mode_t> mode = std::nullopt);

// Gives the file `from` the name `to` on the same file system, never replacing anything: false when
// that name is taken. `from` may keep its own name beside it.
bool take_name(const std::string& from, const std::string& to);

// Copies the database, as it is at one moment, to the new file `path`, with the same permissions.
// Reports the stage "backup" in bytes.
void backup_database(const sqlite::Database& database,
                     const std::string& path,
                     const RunContext& context);

}  // namespace landmarkdb
