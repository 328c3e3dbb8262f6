#include "store/model_changes.hpp"

#include <span>

#include "engine/base/error.hpp"
#include "store/model_bytes.hpp"
#include "store/model_rows.hpp"
#include "store/names.hpp"
#include "store/scene_changes.hpp"
#include "store/scene_rows.hpp"
#include "store/sha256.hpp"
#include "store/utf8.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

constexpr auto kWrite = Transaction::Kind::kWrite;

// Over the version and parameters too: a blob must not be read as another layout's.
std::string index_digest(const ModelIndexBlob& index) {
  Sha256 digest;
  const std::string head = std::to_string(index.version) + "\n" + index.params + "\n";
  digest.update(std::as_bytes(std::span(head)));
  digest.update(index.quads);
  return digest.finish();
}

}  // namespace

InsertModelResult insert_model(const Database& database,
                               const MonoModelRecord& record,
                               const std::vector<std::string>& warnings,
                               const RunContext& context) {
  validate_name(record.model.name, "model name");
  validate_model(record, "model '" + record.model.name + "'", ErrorCode::kInvalidArgument);
  MonoModelRecord stored = record;
  stored.model.source = valid_utf8(record.model.source);  // a file name may be anything

  Transaction transaction(database, kWrite);
  InsertModelResult result;
  if (const auto old = find_model_id(database, stored.model.name)) {
    delete_model(database, *old);
    result.replaced = true;
  }
  result.model_id = write_model(database, stored, warnings, context);
  raise_generation(database);
  result.generation = read_generation(database);
  context.check("store");
  transaction.commit();
  return result;
}

void remove_model(const Database& database, std::string_view name) {
  Transaction transaction(database, kWrite);
  delete_model(database, require_model_row(database, name).id);
  raise_generation(database);
  transaction.commit();
}

void rename_model(const Database& database, std::string_view old_name, std::string_view new_name) {
  validate_name(new_name, "model name");
  Transaction transaction(database, kWrite);
  const ModelRow row = require_model_row(database, old_name);
  const auto taken = find_model_id(database, new_name);
  if (taken && *taken != row.id) {
    throw Error(ErrorCode::kAlreadyExists,
                "there is already a model '" + std::string(new_name) + "'; '" +
                    std::string(old_name) + "' keeps its name",
                "name");
  }
  Statement update(database, "UPDATE mono_model SET name = ? WHERE id = ?");
  update.bind(new_name).bind(row.id);
  update.run();
  raise_generation(database);
  transaction.commit();
}

void save_model_index(const Database& database,
                      std::int64_t model_id,
                      const ModelIndexBlob& index) {
  const std::string digest = index_digest(index);
  Transaction transaction(database, kWrite);
  Statement insert(database,
                   "INSERT OR REPLACE INTO mono_index (model_id, version, params, quads, digest) "
                   "VALUES (?, ?, ?, ?, ?)");
  insert.bind(model_id).bind(index.version).bind(index.params);
  insert.bind(std::span<const std::byte>(index.quads)).bind(digest);
  insert.run();
  transaction.commit();
}

std::optional<ModelIndexBlob> load_model_index(const Database& database, std::int64_t model_id) {
  Statement row(database,
                "SELECT version, params, quads, digest FROM mono_index WHERE model_id = ?");
  row.bind(model_id);
  if (!row.step()) return std::nullopt;
  ModelIndexBlob index;
  index.version = row.integer(0);
  index.params = row.text(1);
  const std::span<const std::byte> quads = row.blob(2);
  index.quads.assign(quads.begin(), quads.end());
  if (index_digest(index) != row.text(3)) return std::nullopt;
  return index;
}

}  // namespace landmarkdb
