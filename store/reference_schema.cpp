#include "store/reference_schema.hpp"

#include <algorithm>
#include <chrono>

#include "store/migrations.hpp"

namespace landmarkdb {
namespace {

std::vector<SchemaObject> schema_objects(const sqlite::Database& database) {
  sqlite::Statement rows(database,
                         "SELECT type, name, sql FROM sqlite_schema "
                         "WHERE sql IS NOT NULL AND name NOT LIKE 'sqlite~_%' ESCAPE '~'");
  std::vector<SchemaObject> objects;
  while (rows.step()) objects.push_back({rows.text(0), rows.text(1), rows.text(2)});
  return objects;
}

}  // namespace

std::vector<SchemaObject> missing_schema_objects(const sqlite::Database& database) {
  const sqlite::Database reference(
      ":memory:", sqlite::OpenMode::kCreate, std::chrono::milliseconds(0));
  apply_migrations(reference, all_migrations());
  const std::vector<SchemaObject> present = schema_objects(database);
  std::vector<SchemaObject> missing;
  for (const SchemaObject& object : schema_objects(reference)) {
    const bool found = std::any_of(present.begin(), present.end(), [&](const SchemaObject& other) {
      return other.type == object.type && other.name == object.name && other.sql == object.sql;
    });
    if (!found) missing.push_back(object);
  }
  return missing;
}

}  // namespace landmarkdb
