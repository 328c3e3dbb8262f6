#include "store/store.hpp"

#include <filesystem>
#include <utility>

#include "engine/base/error.hpp"
#include "store/catalog.hpp"
#include "store/check.hpp"
#include "store/migrations.hpp"
#include "store/model_check.hpp"
#include "store/names.hpp"
#include "store/open.hpp"
#include "store/output_file.hpp"
#include "store/repair.hpp"
#include "store/scene_changes.hpp"
#include "store/scene_file.hpp"
#include "store/scene_index.hpp"
#include "store/scene_rows.hpp"
#include "store/segment.hpp"
#include "store/sqlite.hpp"
#include "store/store_state.hpp"

namespace landmarkdb {

using sqlite::Transaction;

namespace {

// Reading the open database, or a companion of it, as a plain file would drop SQLite's locks on it
// (see has_database() in store/open.cpp).
void refuse_itself(const sqlite::Database& database, const std::string& path) {
  for (const char* suffix : {"", "-wal", "-shm"}) {
    std::error_code missing;
    if (std::filesystem::equivalent(path, database.path() + suffix, missing)) {
      throw Error(ErrorCode::kInvalidArgument,
                  "'" + path + "' cannot be imported: it is the database itself");
    }
  }
}

}  // namespace

int schema_version() { return latest_version(all_migrations()); }

Store::Store(std::unique_ptr<State> state) : state_(std::move(state)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

Store Store::create_or_open(const std::string& path, const StoreOptions& options) {
  return Store(std::make_unique<State>(create_or_open_database(path, options), false));
}

Store Store::open_read_write(const std::string& path, const StoreOptions& options) {
  return Store(std::make_unique<State>(open_database(path, false, options), false));
}

Store Store::open_read_only(const std::string& path, const StoreOptions& options) {
  return Store(std::make_unique<State>(open_database(path, true, options), true));
}

MigrationReport Store::migrate(const std::string& path, bool dry_run, const RunContext& context) {
  return migrate_database(path, dry_run, all_migrations(), context);
}

const std::vector<std::string>& Store::warnings() const { return state_->warnings; }

StoreSize Store::size() const {
  const sqlite::Database& database = state_->reader();
  const auto page = static_cast<std::uint64_t>(database.integer("PRAGMA page_size"));
  StoreSize size;
  size.database_bytes = page * static_cast<std::uint64_t>(database.integer("PRAGMA page_count"));
  size.free_bytes = page * static_cast<std::uint64_t>(database.integer("PRAGMA freelist_count"));
  std::error_code missing;
  const auto wal = std::filesystem::file_size(database.path() + "-wal", missing);
  size.wal_bytes = missing ? 0 : wal;
  return size;
}

std::uint64_t Store::generation() const { return read_generation(state_->reader()); }

std::vector<SceneSummary> Store::list_scenes() const {
  const Transaction snapshot = state_->snapshot();
  return read_summaries(state_->reader());
}

SceneSummary Store::show(std::string_view name) const {
  const Transaction snapshot = state_->snapshot();
  return read_summary(state_->reader(), require_scene_id(state_->reader(), name));
}

std::optional<std::int64_t> Store::find_scene(std::string_view name) const {
  return find_scene_id(state_->reader(), name);
}

std::shared_ptr<const SceneRecord> Store::load(std::string_view name,
                                               std::optional<std::int64_t> version) const {
  const Transaction snapshot = state_->snapshot();
  const std::int64_t scene_id = require_scene_id(state_->reader(), name);
  return load_record(state_->reader(), require_version_row(state_->reader(), scene_id, version));
}

std::shared_ptr<const SceneRecord> Store::load(std::int64_t scene_id,
                                               std::optional<std::int64_t> version) const {
  const Transaction snapshot = state_->snapshot();
  return load_record(state_->reader(), require_version_row(state_->reader(), scene_id, version));
}

std::shared_ptr<const Catalog> Store::load_catalog(const RunContext& context,
                                                   const OnDamaged& on_damaged,
                                                   const Catalog* previous) const {
  return landmarkdb::load_catalog(state_->reader(), Loading::kWhole, context, on_damaged, previous);
}

std::shared_ptr<const Catalog> Store::load_outlines(const RunContext& context,
                                                    const OnDamaged& on_damaged,
                                                    const Catalog* previous) const {
  const bool elsewhere = state_->reader().path() != ":memory:";
  return landmarkdb::load_catalog(state_->reader(),
                                  elsewhere ? Loading::kOutlines : Loading::kWhole,
                                  context,
                                  on_damaged,
                                  previous);
}

InsertResult Store::insert(const SceneRecord& record,
                           const RunContext& context,
                           const SceneDeriver& deriver) {
  const sqlite::Database& database = state_->writer();
  validate_name(record.name, "scene name");
  return insert_version(database, record.name, encode_segment(record), {}, context, deriver);
}

void Store::remove(std::string_view name) { remove_scene(state_->writer(), name); }

void Store::rename(std::string_view old_name, std::string_view new_name) {
  rename_scene(state_->writer(), old_name, new_name);
}

std::int64_t Store::rollback(std::string_view name) {
  return rollback_scene(state_->writer(), name);
}

void Store::tag(std::string_view name, std::string_view key, std::string_view value) {
  set_tag(state_->writer(), name, key, value);
}

void Store::untag(std::string_view name, std::string_view key) {
  remove_tag(state_->writer(), name, key);
}

void Store::change_tags(std::string_view name, const TagChanges& changes) {
  landmarkdb::change_tags(state_->writer(), name, changes);
}

void Store::add_landmark(std::string_view scene, const Landmark& landmark) {
  set_landmark(state_->writer(), scene, landmark);
}

void Store::remove_landmark(std::string_view scene, std::string_view landmark) {
  landmarkdb::remove_landmark(state_->writer(), scene, landmark);
}

std::vector<Landmark> Store::list_landmarks(std::string_view scene) const {
  const Transaction snapshot = state_->snapshot();
  return read_landmarks(state_->reader(), require_scene_id(state_->reader(), scene));
}

CheckReport Store::check(const RunContext& context) const {
  return check_database(state_->reader(), context);
}

RepairReport Store::repair(const RunContext& context,
                           const ModelDeriver& deriver,
                           const SceneDeriver& scene_deriver) {
  return repair_database(state_->writer(), context, deriver, scene_deriver);
}

OptimizeReport Store::optimize(const RunContext& context,
                               const ModelDeriver& deriver,
                               const SceneDeriver& scene_deriver) {
  const sqlite::Database& database = state_->writer();
  OptimizeReport report;
  report.bytes_before = size().database_bytes;
  context.check("optimize");
  report.dropped = drop_old_versions(database);
  if (scene_deriver.index) report.renewed = renew_scene_indexes(database, context, scene_deriver);
  for (std::string& renewed : renew_model_indexes(database, context, deriver)) {
    report.renewed.push_back(std::move(renewed));
  }
  try {
    const sqlite::InterruptGuard guard(database, context);
    database.execute("ANALYZE");
    database.execute("VACUUM");
  } catch (const Error&) {
    context.check("optimize");  // says whether it was a stop request or the deadline
    throw;
  }
  database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  report.bytes_after = size().database_bytes;
  return report;
}

void Store::checkpoint() {
  const sqlite::Database& database = state_->writer();
  // One row: whether it was kept from finishing, and two counts of pages.
  if (database.integer("PRAGMA wal_checkpoint(TRUNCATE)") != 0) {
    throw Error(ErrorCode::kUnavailable,
                "the log of '" + database.path() +
                    "' cannot be brought into it: another connection reads or writes");
  }
}

void Store::backup(const std::string& path, const RunContext& context) const {
  backup_database(state_->reader(), path, context);
}

void Store::export_scene(std::string_view name,
                         const std::string& path,
                         const RunContext& context) const {
  SceneFile file;
  {
    const Transaction snapshot = state_->snapshot();
    const sqlite::Database& database = state_->reader();
    const std::int64_t scene_id = require_scene_id(database, name);
    const VersionRow row = require_version_row(database, scene_id, std::nullopt);
    file.name = row.scene;
    file.extras = {read_tags(database, scene_id), read_landmarks(database, scene_id)};
    file.segment = load_segment(database, row);
  }
  write_new_file(path,
                 [&](const std::string& temporary) { write_scene_file(temporary, file, context); });
}

InsertResult Store::import_scene(const std::string& path,
                                 const RunContext& context,
                                 const std::optional<std::string>& as_name,
                                 const SceneDeriver& deriver) {
  const sqlite::Database& database = state_->writer();
  refuse_itself(database, path);
  const SceneFile file = read_scene_file(path, context);
  return insert_version(
      database, as_name ? *as_name : file.name, file.segment, file.extras, context, deriver);
}

}  // namespace landmarkdb
