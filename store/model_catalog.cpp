#include "store/model_catalog.hpp"

#include <utility>

#include "engine/base/error.hpp"
#include "store/model_rows.hpp"
#include "store/scene_rows.hpp"

namespace landmarkdb {
namespace {

std::shared_ptr<const MonoModelRecord> find_record(const MonoCatalog* catalog,
                                                   const ModelRow& row,
                                                   const std::string& sha256) {
  if (catalog == nullptr) return nullptr;
  for (const MonoCatalogEntry& entry : catalog->entries) {
    if (entry.model_id == row.id && entry.record && entry.record->model.name == row.name &&
        entry.sha256 == sha256) {
      return entry.record;
    }
  }
  return nullptr;
}

}  // namespace

std::shared_ptr<const MonoCatalog> load_mono_catalog(const sqlite::Database& database,
                                                     const RunContext& context,
                                                     const OnDamagedModel& on_damaged,
                                                     const MonoCatalog* previous) {
  const sqlite::Transaction snapshot(database, sqlite::Transaction::Kind::kRead);
  auto catalog = std::make_shared<MonoCatalog>();
  catalog->generation = read_generation(database);
  const std::vector<ModelRow> rows = read_model_rows(database);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    context.report("load", i, rows.size());
    const ModelRow& row = rows[i];
    try {
      if (row.damage) {
        throw Error(ErrorCode::kDataLoss, row.what() + " is marked as damaged: " + *row.damage);
      }
      MonoCatalogEntry entry;
      entry.model_id = row.id;
      // The triples' digest goes along: they are part of what the record holds.
      entry.sha256 = row.sha256 + row.triples_sha256;
      entry.record = find_record(previous, row, entry.sha256);
      if (!entry.record) entry.record = read_model_record(database, row);
      catalog->entries.push_back(std::move(entry));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kDataLoss) throw;
      if (on_damaged) on_damaged({row.id, row.name, error.what()});
    }
  }
  context.report("load", rows.size(), rows.size());
  return catalog;
}

}  // namespace landmarkdb
