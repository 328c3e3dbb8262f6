#include "store/repair.hpp"

#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "store/check.hpp"
#include "store/model_check.hpp"
#include "store/reference_schema.hpp"
#include "store/scene_changes.hpp"
#include "store/scene_index.hpp"
#include "store/scene_rows.hpp"
#include "store/segment_rows.hpp"
#include "store/version_columns.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

constexpr auto kWrite = Transaction::Kind::kWrite;

// A repair that fails on a damaged file is told, and the next one is tried.
template <typename Job>
void attempt(RepairReport& report, const Job& job) {
  try {
    job();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kDataLoss && error.code() != ErrorCode::kInternal) throw;
    report.remaining.emplace_back(error.what());
  }
}

void repair_schema(const Database& database, RepairReport& report) {
  Transaction transaction(database, kWrite);
  std::size_t made = 0;
  for (const SchemaObject& object : missing_schema_objects(database)) {
    if (object.type == "table") {
      report.remaining.push_back("the table '" + object.name +
                                 "' is missing or altered: restore a backup");
      continue;
    }
    database.execute("DROP " + object.type + " IF EXISTS \"" + object.name + "\"");
    database.execute(object.sql);
    report.repaired.push_back("the " + object.type + " '" + object.name + "' was made anew");
    ++made;
  }
  if (made > 0) transaction.commit();
}

void repair_indexes(const Database& database, const RunContext& context, RepairReport& report) {
  if (integrity_findings(database, context).empty()) return;
  attempt(report, [&] { database.execute("REINDEX"); });
  const std::vector<std::string> left = integrity_findings(database, context);
  if (left.empty()) {
    report.repaired.emplace_back("the indexes were built anew");
    return;
  }
  for (const std::string& finding : left) report.remaining.push_back(finding);
  report.remaining.emplace_back(
      "damaged pages cannot be repaired in place: restore a backup, or `export` the scenes that "
      "`check` does not name and `import` them into a new database");
}

void repair_orphans(const Database& database, RepairReport& report) {
  Transaction transaction(database, kWrite);
  std::int64_t dropped = 0;
  const auto drop = [&](const std::string& from, const std::string& name) {
    database.execute("DELETE " + from);
    const std::int64_t count = database.changed_rows();
    if (count > 0) {
      report.repaired.push_back(std::to_string(count) + " " + name +
                                " that belonged to nothing were dropped");
    }
    dropped += count;
  };
  // From the top: what a dropped row held is dropped with it.
  drop(kOrphanSegments, "segments");
  drop(kOrphanArrays, "arrays");
  drop(kOrphanChunks, "chunks");
  drop(kOrphanIndexes, "search indexes of scenes");
  drop("FROM tag WHERE scene_id NOT IN (SELECT id FROM scene)", "tags");
  drop("FROM landmark WHERE scene_id NOT IN (SELECT id FROM scene)", "landmarks");
  if (dropped > 0) transaction.commit();
}

void repair_generation(const Database& database, RepairReport& report) {
  if (database.integer("SELECT count(*) FROM setting WHERE name = 'generation' AND "
                       "typeof(value) = 'integer'") == 1) {
    return;
  }
  // Past any number a running server may hold.
  database.execute(
      "INSERT OR REPLACE INTO setting (name, value) "
      "VALUES ('generation', CAST(strftime('%s', 'now') AS INTEGER))");
  report.repaired.emplace_back("the setting 'generation' was set anew");
}

void mark(const Database& database,
          const VersionRow& row,
          const std::optional<std::string>& damage) {
  Statement update(database,
                   "UPDATE scene_version SET damage = ? WHERE scene_id = ? AND version = ?");
  if (damage) {
    update.bind(*damage);
  } else {
    update.bind_null();
  }
  update.bind(row.scene_id).bind(row.version);
  update.run();
}

std::string advice_for(const Database& database, const VersionRow& row) {
  if (!row.active) return " (it is not the active version)";
  if (!can_roll_back(database, row.scene_id)) return "; `add` makes a new version";
  return "; `rollback " + row.scene + "` goes back to an earlier version, `add` makes a new one";
}

void repair_version(const Database& database,
                    const VersionRow& row,
                    const RunContext& context,
                    const SceneDeriver& deriver,
                    RepairReport& report) {
  Transaction transaction(database, kWrite);
  std::uint64_t bytes = 0;
  const std::optional<std::string> damage = version_damage(database, row, bytes);
  bool changed = false;
  if (damage) {
    report.remaining.push_back(*damage + advice_for(database, row));
    if (row.damage != damage) {
      mark(database, row, damage);
      report.repaired.push_back(row.what() + " is marked as damaged and is not served");
      changed = true;
    }
  } else {
    const Manifest manifest = read_manifest(database, row.segment_id, row.what());
    if (!columns_agree(database, row, manifest)) {
      write_version_columns(database, row.scene_id, row.version, columns_of(manifest));
      report.repaired.push_back(row.what() + ": what is listed of it was written anew");
      changed = true;
    }
    if (const auto renewed = renew_scene_index(database, row, deriver, context)) {
      report.repaired.push_back(*renewed);
      changed = true;
    }
    if (row.damage) {
      mark(database, row, std::nullopt);
      report.repaired.push_back(row.what() + " is whole: the mark of damage was taken away");
      changed = true;
    }
  }
  if (!changed) return;
  raise_generation(database);
  transaction.commit();
}

void note_inactive_scenes(const Database& database, RepairReport& report) {
  for (const SceneSummary& scene : read_summaries(database)) {
    if (scene.active_version != 0) continue;
    report.remaining.push_back(
        "scene '" + scene.name + "' has no active version" +
        (scene.versions.empty() ? "; `remove` it or `add` it anew" : "; `rollback` activates one"));
  }
}

}  // namespace

RepairReport repair_database(const Database& database,
                             const RunContext& context,
                             const ModelDeriver& deriver,
                             const SceneDeriver& scene_deriver) {
  RepairReport report;
  context.check("repair");
  attempt(report, [&] { repair_schema(database, report); });
  repair_indexes(database, context, report);
  attempt(report, [&] { repair_orphans(database, report); });
  attempt(report, [&] { repair_generation(database, report); });
  attempt(report, [&] {
    const std::vector<VersionRow> versions = read_versions(database);
    for (std::size_t i = 0; i < versions.size(); ++i) {
      context.report("repair", i, versions.size());
      attempt(report,
              [&] { repair_version(database, versions[i], context, scene_deriver, report); });
    }
    note_inactive_scenes(database, report);
  });
  attempt(report, [&] { repair_models(database, context, deriver, report); });
  return report;
}

}  // namespace landmarkdb
