#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/scene_record.hpp"
#include "store/model_types.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// The number of schema/'s last migration: the version of the files this program writes.
int schema_version();

// A landmarkdb database: one SQLite file, described in schema/README.md.
//
// Each change is one transaction: done whole, or not at all (also after kill -9, a full disk or a
// stop request). A stored scene version never changes; `insert` under a name that exists adds a
// version and activates it. Other processes may read while one writes; a second writer waits
// `StoreOptions::busy_timeout`, then gets Error{kUnavailable}.
//
// Every member throws Error: kNotFound for a name, version or landmark that is not there,
// kInvalidArgument for bad names, kDataLoss for damage, kUnavailable when another process holds
// the file, kResourceExhausted on a full disk, kPermissionDenied for a change through a read-only
// store or file.
//
// Not thread-safe: one thread at a time. Opening is cheap; give each thread its own.
class Store {
 public:
  // Opens a database for reading and writing; makes it where there is none. ":memory:" makes one
  // that lives as long as the Store.
  static Store create_or_open(const std::string& path, const StoreOptions& options = {});
  // Open one that exists: Error{kInvalidArgument} where there is none or the file is no landmarkdb
  // database, Error{kUnimplemented} where it is of another schema version (an older one is changed
  // by migrate() only). A read-only store never changes the file's bytes.
  static Store open_read_write(const std::string& path, const StoreOptions& options = {});
  static Store open_read_only(const std::string& path, const StoreOptions& options = {});

  // Brings a file of an older version to this one's, after a backup copy beside it. With `dry_run`
  // only says what it would do.
  static MigrationReport migrate(const std::string& path, bool dry_run, const RunContext& context);

  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  // What the user should know about where the file lies (a network file system); often empty.
  const std::vector<std::string>& warnings() const;
  StoreSize size() const;

  // Grows with each change, whoever makes it. One small read: cheap to poll.
  std::uint64_t generation() const;

  // By name.
  std::vector<SceneSummary> list_scenes() const;
  SceneSummary show(std::string_view name) const;
  std::optional<std::int64_t> find_scene(std::string_view name) const;

  // Reads and verifies one version; the active one if none is named. Error{kDataLoss} says which
  // array is damaged and how.
  std::shared_ptr<const SceneRecord> load(std::string_view name,
                                          std::optional<std::int64_t> version = std::nullopt) const;
  std::shared_ptr<const SceneRecord> load(std::int64_t scene_id,
                                          std::optional<std::int64_t> version = std::nullopt) const;

  // Reads the active version of every scene. A damaged scene is left out and told to `on_damaged`
  // (may be empty). Records that `previous` already holds are shared, not read again. Each scene is
  // a read transaction of its own; reports the stage "load".
  std::shared_ptr<const Catalog> load_catalog(const RunContext& context,
                                              const OnDamaged& on_damaged = {},
                                              const Catalog* previous = nullptr) const;

  // The same without the scenes' arrays: each entry's record is an outline, and its source reads
  // the rest from this file when it is asked to. Damage of an array is found then. A database in
  // memory cannot be read from elsewhere and gives load_catalog's.
  std::shared_ptr<const Catalog> load_outlines(const RunContext& context,
                                               const OnDamaged& on_damaged = {},
                                               const Catalog* previous = nullptr) const;

  // Stores a version of `record.name` and activates it, with what `deriver` makes of it. Reports
  // the stage "store" in bytes; a stop request between chunks leaves the database as it was.
  InsertResult insert(const SceneRecord& record,
                      const RunContext& context,
                      const SceneDeriver& deriver = {});

  // Removes a scene with all its versions, tags and landmarks.
  void remove(std::string_view name);
  // Error{kAlreadyExists} when `new_name` is taken.
  void rename(std::string_view old_name, std::string_view new_name);
  // Activates the latest undamaged version before the active one and returns its number;
  // Error{kFailedPrecondition} when there is none.
  std::int64_t rollback(std::string_view name);

  void tag(std::string_view name, std::string_view key, std::string_view value);
  void untag(std::string_view name, std::string_view key);  // Error{kNotFound} without such a tag
  // Several of both at once.
  void change_tags(std::string_view name, const TagChanges& changes);

  // Adds or replaces a landmark of that name; the box must have min < max on each axis.
  void add_landmark(std::string_view scene, const Landmark& landmark);
  void remove_landmark(std::string_view scene, std::string_view landmark);
  std::vector<Landmark> list_landmarks(std::string_view scene) const;

  // Monocular models, by name; their names have nothing to do with those of scenes.
  std::vector<ModelSummary> list_models() const;
  ModelSummary show_model(std::string_view name) const;
  // Reads and verifies one; Error{kDataLoss} says what is damaged.
  std::shared_ptr<const MonoModelRecord> load_model(std::string_view name) const;
  // All of them as of one moment; as load_catalog does for scenes.
  std::shared_ptr<const MonoCatalog> load_models(const RunContext& context,
                                                 const OnDamagedModel& on_damaged = {},
                                                 const MonoCatalog* previous = nullptr) const;
  // Stores a model with what its reader warned of; one of that name is replaced, in one
  // transaction. Error{kInvalidArgument} for a bad name or a record that does not fit together.
  InsertModelResult insert_model(const MonoModelRecord& record,
                                 const std::vector<std::string>& warnings,
                                 const RunContext& context);
  void remove_model(std::string_view name);
  void rename_model(std::string_view old_name, std::string_view new_name);

  // Reads everything: pages, references, digests, shapes. Finds damage, never throws for it (but
  // for a file too broken to be opened at all). Reports the stage "check" in bytes.
  CheckReport check(const RunContext& context) const;
  // Rebuilds what is derived, drops what nothing refers to, marks damaged versions and models so
  // that they are not served. Never removes a scene or model or changes which version is active.
  // Damaged triples of models, and missing or outdated search indexes, are made anew where
  // the derivers say how.
  RepairReport repair(const RunContext& context,
                      const ModelDeriver& deriver = {},
                      const SceneDeriver& scene_deriver = {});
  // Lets go of versions other than the active one and the one `rollback` would go to, and gives the
  // space back; makes search indexes as repair() does. Needs free disk space as large as the
  // database for the time it runs.
  OptimizeReport optimize(const RunContext& context,
                          const ModelDeriver& deriver = {},
                          const SceneDeriver& scene_deriver = {});

  // Brings what was written so far into the database file itself and empties the log beside it;
  // Error{kUnavailable} while another connection reads or writes.
  void checkpoint();

  // A consistent copy, also while others write. Error{kAlreadyExists} when there is a file at
  // `path`; what is written appears there only when it is whole. Reports the stage "backup".
  void backup(const std::string& path, const RunContext& context) const;

  // One scene's active version with its tags and landmarks as a portable file
  // (store/scene_file.hpp). Error{kAlreadyExists} when there is a file at `path`.
  void export_scene(std::string_view name,
                    const std::string& path,
                    const RunContext& context) const;
  // Stores what export_scene wrote, under its own name or `as_name`; a name that exists gets a new
  // version. Error{kInvalidArgument} for a file that is damaged, cut off or something else.
  InsertResult import_scene(const std::string& path,
                            const RunContext& context,
                            const std::optional<std::string>& as_name = std::nullopt,
                            const SceneDeriver& deriver = {});

 private:
  struct State;
  explicit Store(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb
