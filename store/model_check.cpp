#include "store/model_check.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "engine/base/error.hpp"
#include "store/model_bytes.hpp"
#include "store/model_rows.hpp"
#include "store/scene_changes.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

// What is wrong with what `job` reads; nothing where all is well.
template <typename Job>
std::optional<std::string> damage_of(const Job& job) {
  try {
    job();
    return std::nullopt;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kDataLoss && error.code() != ErrorCode::kInternal) throw;
    return error.what();
  }
}

bool masks_agree(const Database& database, const ModelRow& row, const MonoModel& model) {
  Statement rows(database,
                 "SELECT idx, edge_mask FROM mono_feature WHERE model_id = ? ORDER BY idx");
  rows.bind(row.id);
  while (rows.step()) {
    const std::vector<std::byte> want =
        edge_mask_of(model, static_cast<std::uint32_t>(rows.integer(0)));
    const std::span<const std::byte> seen = rows.blob(1);
    if (!std::equal(seen.begin(), seen.end(), want.begin(), want.end())) return false;
  }
  return true;
}

bool has_index(const Database& database, const ModelRow& row) {
  return database.integer("SELECT count(*) FROM mono_index WHERE model_id = " +
                          std::to_string(row.id)) > 0;
}

// Rows whose model is not there.
std::string orphans(const std::string& table) {
  return "FROM " + table + " WHERE model_id NOT IN (SELECT id FROM mono_model)";
}
constexpr const char* kTables[] = {
    "mono_index", "mono_triple", "mono_circle", "mono_face", "mono_edge", "mono_feature"};

void check_model(const Database& database, const ModelRow& row, CheckReport& report) {
  MonoModel model;
  const auto damage = damage_of([&] { model = read_model_tables(database, row); });
  if (damage) {
    report.findings.push_back(*damage);
    return;
  }
  report.bytes += model.points.size() * sizeof(ModelFeature);
  if (const auto triples = damage_of([&] { read_model_record(database, row); })) {
    report.findings.push_back(*triples);
  }
  if (!masks_agree(database, row, model)) {
    report.findings.push_back(
        row.what() + ": its edge masks disagree with its edges; `repair` writes them anew");
  }
  if (has_index(database, row) && !read_model_index_row(database, row)) {
    report.findings.push_back(row.what() + ": its search index is damaged; `repair` makes it anew");
  }
  if (row.damage) {
    report.findings.push_back(row.what() + " is marked as damaged (" + *row.damage +
                              ") but is whole; `repair` takes the mark away");
  }
}

void mark(const Database& database, const ModelRow& row, const std::optional<std::string>& damage) {
  Statement update(database, "UPDATE mono_model SET damage = ? WHERE id = ?");
  damage ? update.bind(*damage) : update.bind_null();
  update.bind(row.id);
  update.run();
}

void write_masks(const Database& database, const ModelRow& row, const MonoModel& model) {
  Statement update(database,
                   "UPDATE mono_feature SET edge_mask = ? WHERE model_id = ? AND idx = ?");
  for (std::uint32_t i = 0; i < model.points.size(); ++i) {
    const std::vector<std::byte> mask = edge_mask_of(model, i);
    update.bind(std::span<const std::byte>(mask)).bind(row.id).bind(std::int64_t{i});
    update.run();
  }
}

// What was done to the index, where anything had to be.
std::optional<std::string> renew_index(const Database& database,
                                       const ModelRow& row,
                                       const MonoModel& model,
                                       const ModelDeriver& deriver,
                                       const RunContext& context) {
  const std::optional<ModelIndexBlob> index = read_model_index_row(database, row);
  if (deriver.index) {
    if (index && index->is_made_like(deriver.index_format)) return std::nullopt;
    write_model_index(database, row.id, row.sha256, deriver.index(model, context));
    return row.what() + ": its search index was made anew";
  }
  if (index || !has_index(database, row)) return std::nullopt;
  database.execute("DELETE FROM mono_index WHERE model_id = " + std::to_string(row.id));
  return row.what() + ": its damaged search index was dropped";
}

class ModelRepair {
 public:
  ModelRepair(const Database& database, const RunContext& context, const ModelDeriver& deriver)
      : database_(database), context_(context), deriver_(deriver) {}

  void run(const ModelRow& row, RepairReport& report) const {
    Transaction transaction(database_, Transaction::Kind::kWrite);
    const std::size_t before = report.repaired.size();
    MonoModel model;
    if (const auto damage = damage_of([&] { model = read_model_tables(database_, row); })) {
      report.remaining.push_back(*damage + "; `model add` or `import` stores it anew");
      if (row.damage != damage) {
        mark(database_, row, damage);
        report.repaired.push_back(row.what() + " is marked as damaged and is not served");
      }
    } else {
      repair_derived(row, model, report);
    }
    if (report.repaired.size() == before) return;
    raise_generation(database_);
    transaction.commit();
  }

 private:
  void repair_derived(const ModelRow& row, const MonoModel& model, RepairReport& report) const {
    if (const auto triples = damage_of([&] { read_model_record(database_, row); })) {
      if (deriver_.triples) {
        write_triples(database_, row.id, deriver_.triples(model, context_), context_);
        report.repaired.push_back(row.what() + ": its triples were made anew");
      } else {
        report.remaining.push_back(*triples);
      }
    }
    if (!masks_agree(database_, row, model)) {
      write_masks(database_, row, model);
      report.repaired.push_back(row.what() + ": its edge masks were written anew");
    }
    if (const auto done = renew_index(database_, row, model, deriver_, context_)) {
      report.repaired.push_back(*done);
    }
    if (row.damage) {
      mark(database_, row, std::nullopt);
      report.repaired.push_back(row.what() + " is whole: the mark of damage was taken away");
    }
  }

  const Database& database_;
  const RunContext& context_;
  const ModelDeriver& deriver_;
};

}  // namespace

void check_models(const Database& database, const RunContext& context, CheckReport& report) {
  const Transaction snapshot(database, Transaction::Kind::kRead);
  for (const char* table : kTables) {
    const std::int64_t count = database.integer("SELECT count(*) " + orphans(table));
    if (count == 0) continue;
    report.findings.push_back(std::to_string(count) + " rows of " + table +
                              " belong to nothing; `repair` drops them");
  }
  for (const ModelRow& row : read_model_rows(database)) {
    context.check("check");
    ++report.models;
    check_model(database, row, report);
  }
}

void repair_models(const Database& database,
                   const RunContext& context,
                   const ModelDeriver& deriver,
                   RepairReport& report) {
  for (const char* table : kTables) {
    database.execute("DELETE " + orphans(table));
    const std::int64_t count = database.changed_rows();
    if (count > 0) {
      report.repaired.push_back(std::to_string(count) + " rows of " + table +
                                " that belonged to nothing were dropped");
    }
  }
  for (const ModelRow& row : read_model_rows(database)) {
    context.check("repair");
    ModelRepair(database, context, deriver).run(row, report);
  }
}

std::vector<std::string> renew_model_indexes(const Database& database,
                                             const RunContext& context,
                                             const ModelDeriver& deriver) {
  std::vector<std::string> renewed;
  const std::vector<ModelRow> rows = read_model_rows(database);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    context.report("index", i, rows.size());
    if (rows[i].damage) continue;
    Transaction transaction(database, Transaction::Kind::kWrite);
    MonoModel model;
    if (damage_of([&] { model = read_model_tables(database, rows[i]); })) continue;
    const auto done = renew_index(database, rows[i], model, deriver, context);
    if (!done) continue;
    renewed.push_back(*done);
    transaction.commit();
  }
  return renewed;
}

}  // namespace landmarkdb
