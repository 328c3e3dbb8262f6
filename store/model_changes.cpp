#include "store/model_changes.hpp"

#include "engine/base/error.hpp"
#include "store/model_bytes.hpp"
#include "store/model_rows.hpp"
#include "store/names.hpp"
#include "store/scene_changes.hpp"
#include "store/scene_rows.hpp"
#include "store/utf8.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

constexpr auto kWrite = Transaction::Kind::kWrite;

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

}  // namespace landmarkdb
