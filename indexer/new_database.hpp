#pragma once

#include <functional>
#include <string>

#include "store/store.hpp"

namespace landmarkdb::indexer {

// Throws what would stand in the way of writing the database at `path`, before hours of work: a
// file that is no database of this version, a folder that is missing or may not be written to.
// Changes nothing.
void require_writable_database(const std::string& path);

// Runs one change on the database at `path`. Where there is none, or an empty file, the change is
// made in a new file beside it that takes the name only when it is whole: a change that fails
// leaves no database behind. `change` runs again on what is at `path` when the name is taken.
InsertResult change_or_create(const std::string& path,
                              const std::function<InsertResult(Store&)>& change);

}  // namespace landmarkdb::indexer
