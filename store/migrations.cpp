#include "store/migrations.hpp"

namespace landmarkdb {

int user_version(const sqlite::Database& database) {
  return static_cast<int>(database.integer("PRAGMA user_version"));
}

int latest_version(std::span<const Migration> migrations) {
  return migrations.empty() ? 0 : migrations.back().version;
}

std::vector<std::string> pending_migrations(int version, std::span<const Migration> migrations) {
  std::vector<std::string> names;
  for (const Migration& migration : migrations) {
    if (migration.version > version) names.emplace_back(migration.name);
  }
  return names;
}

namespace {

// Inside a transaction of the caller's.
void apply(const sqlite::Database& database, const Migration& migration) {
  database.execute(std::string(migration.sql));
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.execute("PRAGMA user_version = " + std::to_string(migration.version));
}

}  // namespace

void create_schema(const sqlite::Database& database, std::span<const Migration> migrations) {
  sqlite::Transaction transaction(database, sqlite::Transaction::Kind::kWrite);
  for (const Migration& migration : migrations) {
    if (user_version(database) < migration.version) apply(database, migration);
  }
  transaction.commit();
}

std::vector<std::string> apply_migrations(const sqlite::Database& database,
                                          std::span<const Migration> migrations) {
  std::vector<std::string> applied;
  for (const Migration& migration : migrations) {
    sqlite::Transaction transaction(database, sqlite::Transaction::Kind::kWrite);
    // Looked up inside the transaction: another process may have been faster.
    if (user_version(database) >= migration.version) continue;
    apply(database, migration);
    transaction.commit();
    applied.emplace_back(migration.name);
  }
  return applied;
}

}  // namespace landmarkdb
