#include "store/model_check.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "engine/base/error.hpp"
#include "store/model_bytes.hpp"
#include "store/model_changes.hpp"
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
  if (has_index(database, row) && !load_model_index(database, row.id)) {
    report.findings.push_back(row.what() +
                              ": its search index is damaged; `repair` drops it, it is made anew");
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

class ModelRepair {
 public:
  ModelRepair(const Database& database, const RunContext& context, const MakeTriples& make_triples)
      : database_(database), context_(context), make_triples_(make_triples) {}

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
      if (make_triples_) {
        write_triples(database_, row.id, make_triples_(model, context_), context_);
        report.repaired.push_back(row.what() + ": its triples were made anew");
      } else {
        report.remaining.push_back(*triples);
      }
    }
    if (!masks_agree(database_, row, model)) {
      write_masks(database_, row, model);
      report.repaired.push_back(row.what() + ": its edge masks were written anew");
    }
    if (has_index(database_, row) && !load_model_index(database_, row.id)) {
      database_.execute("DELETE FROM mono_index WHERE model_id = " + std::to_string(row.id));
      report.repaired.push_back(row.what() + ": its damaged search index was dropped");
    }
    if (row.damage) {
      mark(database_, row, std::nullopt);
      report.repaired.push_back(row.what() + " is whole: the mark of damage was taken away");
    }
  }

  const Database& database_;
  const RunContext& context_;
  const MakeTriples& make_triples_;
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
                   const MakeTriples& make_triples,
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
    ModelRepair(database, context, make_triples).run(row, report);
  }
}

}  // namespace landmarkdb
