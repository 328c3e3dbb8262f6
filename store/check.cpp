#include "store/check.hpp"

#include <utility>

#include "engine/base/error.hpp"
#include "store/catalog.hpp"
#include "store/model_check.hpp"
#include "store/reference_schema.hpp"
#include "store/scene_index.hpp"
#include "store/segment_rows.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

// Damage is a finding; being stopped is not.
template <typename Job>
void collect(std::vector<std::string>& findings, const Job& job) {
  try {
    job();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kCancelled || error.code() == ErrorCode::kDeadlineExceeded) {
      throw;
    }
    findings.emplace_back(error.what());
  }
}

void check_schema(const Database& database, std::vector<std::string>& findings) {
  for (const SchemaObject& object : missing_schema_objects(database)) {
    findings.push_back("the " + object.type + " '" + object.name + "' is missing or altered");
  }
}

void check_references(const Database& database, std::vector<std::string>& findings) {
  Statement rows(database, "PRAGMA foreign_key_check");
  while (rows.step()) {
    findings.push_back("a row of '" + rows.text(0) + "' refers to a row of '" + rows.text(2) +
                       "' that is not there");
  }
}

void check_orphans(const Database& database, std::vector<std::string>& findings) {
  for (const auto& [from, name] : {std::pair{kOrphanSegments, "segments"},
                                   std::pair{kOrphanArrays, "arrays"},
                                   std::pair{kOrphanChunks, "chunks"},
                                   std::pair{kOrphanIndexes, "search indexes of scenes"}}) {
    const std::int64_t count = database.integer(std::string("SELECT count(*) ") + from);
    if (count > 0) {
      findings.push_back(std::to_string(count) + " " + name +
                         " belong to nothing; `repair` drops them");
    }
  }
}

void check_generation(const Database& database, std::vector<std::string>& findings) {
  if (database.integer("SELECT count(*) FROM setting WHERE name = 'generation' AND "
                       "typeof(value) = 'integer'") != 1) {
    findings.emplace_back("the setting 'generation' is missing or no integer");
  }
}

void check_active_versions(const Database& database, std::vector<std::string>& findings) {
  Statement rows(database,
                 "SELECT name FROM scene WHERE NOT EXISTS (SELECT 1 FROM scene_version "
                 "WHERE scene_id = scene.id AND state = 'active') ORDER BY name");
  while (rows.step()) {
    findings.push_back("scene '" + rows.text(0) +
                       "' has no active version; `rollback` activates its latest");
  }
}

// Each damaged array of a version; `damage`, the first thing wrong, where it is none of them.
void note_damage(const Database& database,
                 const VersionRow& row,
                 const std::string& damage,
                 const RunContext& context,
                 CheckReport& report) {
  std::vector<std::string> faults;
  try {
    const Manifest manifest = read_manifest(database, row.segment_id, row.what());
    faults = array_faults(database, row.segment_id, manifest, row.what(), context, report.bytes);
    report.arrays += manifest.arrays.size();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kDataLoss && error.code() != ErrorCode::kUnimplemented) throw;
  }
  if (faults.empty()) faults.push_back(damage);
  report.findings.insert(report.findings.end(), faults.begin(), faults.end());
}

void check_version(const Database& database,
                   const VersionRow& row,
                   const RunContext& context,
                   CheckReport& report) {
  const Transaction snapshot(database, Transaction::Kind::kRead);
  const std::uint64_t before = report.bytes;
  const std::optional<std::string> damage = version_damage(database, row, report.bytes);
  if (damage) {
    report.bytes = before;  // arrays are read again, one by one
    note_damage(database, row, *damage, context, report);
    return;
  }
  const Manifest manifest = read_manifest(database, row.segment_id, row.what());
  report.arrays += manifest.arrays.size();
  if (!columns_agree(database, row, manifest)) {
    report.findings.push_back(row.what() +
                              ": what is listed of it disagrees with its manifest; `repair` "
                              "writes it anew");
  }
  if (has_scene_index(database, row.segment_id) && !read_scene_index(database, row, true)) {
    report.findings.push_back(row.what() + ": its search index is damaged; `repair` makes it anew");
  }
  if (row.damage) {
    report.findings.push_back(row.what() + " is marked as damaged (" + *row.damage +
                              ") but is whole; `repair` takes the mark away");
  }
}

}  // namespace

std::vector<std::string> integrity_findings(const Database& database, const RunContext& context) {
  std::vector<std::string> findings;
  collect(findings, [&] {
    try {
      const sqlite::InterruptGuard guard(database, context);
      Statement rows(database, "PRAGMA integrity_check(50)");
      while (rows.step()) {
        if (rows.text(0) != "ok") findings.push_back("the file: " + rows.text(0));
      }
    } catch (const Error&) {
      context.check("check");  // says whether it was a stop request or the deadline
      throw;
    }
  });
  return findings;
}

std::optional<std::string> version_damage(const Database& database,
                                          const VersionRow& row,
                                          std::uint64_t& bytes) {
  try {
    Segment segment = load_segment(database, row);
    bytes += segment.bytes();
    decode_segment(std::move(segment), row.scene, row.what());
    return std::nullopt;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kUnavailable || error.code() == ErrorCode::kResourceExhausted) {
      throw;
    }
    return error.what();
  }
}

CheckReport check_database(const Database& database, const RunContext& context) {
  CheckReport report;
  context.check("check");
  report.findings = integrity_findings(database, context);
  collect(report.findings, [&] { check_schema(database, report.findings); });
  collect(report.findings, [&] { check_references(database, report.findings); });
  collect(report.findings, [&] { check_orphans(database, report.findings); });
  collect(report.findings, [&] { check_generation(database, report.findings); });
  collect(report.findings, [&] { check_active_versions(database, report.findings); });
  collect(report.findings, [&] {
    report.scenes = static_cast<std::uint64_t>(database.integer("SELECT count(*) FROM scene"));
    const auto total =
        static_cast<std::uint64_t>(database.integer("SELECT sum(bytes) FROM segment"));
    for (const VersionRow& row : read_versions(database)) {
      context.report("check", report.bytes, total);
      ++report.versions;
      collect(report.findings, [&] { check_version(database, row, context, report); });
    }
    context.report("check", total, total);
  });
  collect(report.findings, [&] { check_models(database, context, report); });
  return report;
}

}  // namespace landmarkdb
