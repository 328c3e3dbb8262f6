#pragma once

#include <string>
#include <vector>

#include "store/sqlite.hpp"

namespace landmarkdb {

// A table, index or view as sqlite_schema tells it.
struct SchemaObject {
  std::string type;
  std::string name;
  std::string sql;  // what makes it
};

// What a database of schema_version() should hold and this one does not, or has differently.
std::vector<SchemaObject> missing_schema_objects(const sqlite::Database& database);

}  // namespace landmarkdb
