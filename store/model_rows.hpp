#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// Reads and writes of the model tables; each within the caller's transaction.

struct ModelRow {
  std::int64_t id = 0;
  std::string name;
  std::string sha256;  // of the model
  std::string triples_sha256;
  std::optional<std::string> damage{};

  std::string what() const { return "model '" + name + "'"; }
};

std::vector<ModelRow> read_model_rows(const sqlite::Database& database);
std::optional<std::int64_t> find_model_id(const sqlite::Database& database, std::string_view name);
// Throws Error{kNotFound} naming the model.
ModelRow require_model_row(const sqlite::Database& database, std::string_view name);

ModelSummary read_model_summary(const sqlite::Database& database, std::int64_t model_id);

// The model with its digest checked, without its triples. Error{kDataLoss} beginning with "model
// 'name'".
MonoModel read_model_tables(const sqlite::Database& database, const ModelRow& row);
// Its triples, with their digest checked.
std::vector<ModelTriple> read_triples(const sqlite::Database& database, const ModelRow& row);
// Its search index; nothing where there is none, or where its digest says that it is damaged or of
// another model.
std::optional<ModelIndexBlob> read_model_index_row(const sqlite::Database& database,
                                                   const ModelRow& row);
// All three, and they fit together.
std::shared_ptr<const MonoModelRecord> read_model_record(const sqlite::Database& database,
                                                         const ModelRow& row);

// Returns the new row's id.
std::int64_t write_model(const sqlite::Database& database,
                         const MonoModelRecord& record,
                         const std::vector<std::string>& warnings,
                         const RunContext& context);
// Replaces a model's triples.
void write_triples(const sqlite::Database& database,
                   std::int64_t model_id,
                   const std::vector<ModelTriple>& triples,
                   const RunContext& context);

// Replaces a model's search index; it is derived, so the generation stays.
void write_model_index(const sqlite::Database& database,
                       std::int64_t model_id,
                       const std::string& model_sha256,
                       const ModelIndexBlob& index);

void delete_model(const sqlite::Database& database, std::int64_t model_id);

}  // namespace landmarkdb
