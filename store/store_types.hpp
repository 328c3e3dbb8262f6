#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/base/error.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

struct StoreOptions {
  // How long a call waits for another process to finish its write before it gives up.
  std::chrono::milliseconds busy_timeout{5000};
  // The database file may not grow past this; 0: as far as the disk goes.
  std::uint64_t max_bytes = 0;
};

// One stored version of a scene. Times are UTC, "2024-05-01T12:00:00Z".
struct VersionSummary {
  std::int64_t version = 0;
  bool active = false;
  std::string created;
  std::string retired;  // empty while active
  std::uint64_t points = 0;
  std::uint64_t keypoints = 0;
  std::uint64_t bytes = 0;            // of its arrays
  std::string sha256;                 // of the segment's manifest, 64 hexadecimal digits
  std::optional<std::string> damage;  // what is wrong, once a check or repair has marked it
};

// What can be said of a scene without reading its arrays. Counts, options, sources and warnings are
// those of the active version.
struct SceneSummary {
  std::int64_t id = 0;
  std::string name;
  EntryKind kind = EntryKind::kPlace;
  std::int64_t active_version = 0;
  std::vector<VersionSummary> versions;  // ascending
  std::string created;                   // when the scene was first added
  std::uint64_t points = 0;
  std::uint64_t keypoints = 0;
  std::uint64_t bytes = 0;  // of all versions
  FeatureOptions options;
  std::optional<Eigen::Vector3d> up;
  std::vector<std::string> sources;
  std::vector<std::string> warnings;
  std::map<std::string, std::string> tags;
  std::vector<Landmark> landmarks;    // by name
  std::optional<std::string> damage;  // of the active version: it is not served
};

// By key; nothing stands for taking the tag away.
using TagChanges = std::map<std::string, std::optional<std::string>>;

struct InsertResult {
  std::int64_t scene_id = 0;
  std::int64_t version = 0;      // 1 for a new name
  std::uint64_t generation = 0;  // of the database, after the insert
};

// A scene left out of a catalogue because it cannot be read.
struct DamagedScene {
  std::int64_t scene_id = 0;
  std::string name;
  std::int64_t version = 0;
  std::string what;
};
using OnDamaged = std::function<void(const DamagedScene&)>;

// How what is derived from a scene is made; the store keeps it but does not know how. `record`: as
// it is read back from the database, but for its name.
struct SceneDeriver {
  std::function<SceneIndexBlob(const SceneRecord& record, const RunContext&)> index{};
  SceneIndexBlob index_format{};  // version and params of what `index` makes
};

// What `check` saw. Every finding is a sentence that names the scene, version and array at fault.
struct CheckReport {
  std::vector<std::string> findings;
  std::uint64_t scenes = 0;
  std::uint64_t versions = 0;
  std::uint64_t arrays = 0;
  std::uint64_t models = 0;
  std::uint64_t bytes = 0;  // of the arrays and models that were read
  bool ok() const { return findings.empty(); }
};

struct RepairReport {
  std::vector<std::string> repaired;   // what was put right
  std::vector<std::string> remaining;  // what was not, with what the user can do
  bool ok() const { return remaining.empty(); }
};

struct OptimizeReport {
  std::vector<std::string> dropped;  // versions that were let go, one sentence each
  std::vector<std::string> renewed;  // search indexes that were made, the same
  std::uint64_t bytes_before = 0;    // of the database file
  std::uint64_t bytes_after = 0;
};

struct MigrationReport {
  int from_version = 0;
  int to_version = 0;
  std::vector<std::string> steps;  // the migrations that were (or with a dry run: would be) applied
  std::string backup_path;         // empty where nothing had to be done, or in a dry run
};

struct StoreSize {
  std::uint64_t database_bytes = 0;
  std::uint64_t wal_bytes = 0;   // changes not yet merged into the file
  std::uint64_t free_bytes = 0;  // within the file; `optimize` gives them back
};

}  // namespace landmarkdb
