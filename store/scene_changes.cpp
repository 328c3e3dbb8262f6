#include "store/scene_changes.hpp"

#include <chrono>
#include <ctime>
#include <optional>

#include "engine/base/error.hpp"
#include "store/names.hpp"
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

std::int64_t make_scene(const Database& database, const std::string& name) {
  if (const auto id = find_scene_id(database, name)) return *id;
  const std::string now = utc_now();
  Statement insert(database, "INSERT INTO scene (name, created) VALUES (?, ?)");
  insert.bind(name).bind(now);
  insert.run();
  return database.last_insert_id();
}

std::int64_t next_version(const Database& database, std::int64_t scene_id) {
  // A counter of its own: a number that was once given away is not used again.
  Statement raise(database, "UPDATE scene SET last_version = last_version + 1 WHERE id = ?");
  raise.bind(scene_id);
  raise.run();
  Statement row(database, "SELECT last_version FROM scene WHERE id = ?");
  row.bind(scene_id);
  row.step();
  return row.integer(0);
}

void retire_active(const Database& database, std::int64_t scene_id) {
  const std::string now = utc_now();
  Statement update(database,
                   "UPDATE scene_version SET state = 'retired', retired = ? "
                   "WHERE scene_id = ? AND state = 'active'");
  update.bind(now).bind(scene_id);
  update.run();
}

void activate(const Database& database, std::int64_t scene_id, std::int64_t version) {
  retire_active(database, scene_id);
  Statement update(database,
                   "UPDATE scene_version SET state = 'active', retired = NULL "
                   "WHERE scene_id = ? AND version = ?");
  update.bind(scene_id).bind(version);
  update.run();
}

void write_tag(const Database& database,
               std::int64_t scene_id,
               std::string_view key,
               std::string_view value) {
  Statement insert(database, "INSERT OR REPLACE INTO tag (scene_id, key, value) VALUES (?, ?, ?)");
  insert.bind(scene_id).bind(key).bind(value);
  insert.run();
}

void delete_tag(const Database& database,
                std::int64_t scene_id,
                std::string_view name,
                std::string_view key) {
  Statement remove(database, "DELETE FROM tag WHERE scene_id = ? AND key = ?");
  remove.bind(scene_id).bind(key);
  remove.run();
  if (database.changed_rows() > 0) return;
  throw Error(ErrorCode::kNotFound,
              "scene '" + std::string(name) + "' has no tag '" + std::string(key) + "'",
              "tag");
}

void write_landmark(const Database& database, std::int64_t scene_id, const Landmark& landmark) {
  Statement insert(database,
                   "INSERT OR REPLACE INTO landmark (scene_id, name, min_x_m, min_y_m, min_z_m, "
                   "max_x_m, max_y_m, max_z_m) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind(scene_id).bind(landmark.name);
  for (int axis = 0; axis < 3; ++axis) insert.bind(landmark.min_m[axis]);
  for (int axis = 0; axis < 3; ++axis) insert.bind(landmark.max_m[axis]);
  insert.run();
}

void delete_version(const Database& database, const VersionRow& row) {
  Statement remove(database, "DELETE FROM scene_version WHERE scene_id = ? AND version = ?");
  remove.bind(row.scene_id).bind(row.version);
  remove.run();
  delete_segment(database, row.segment_id);
}

// The version `rollback` goes to: the latest undamaged one before the active one, or before all
// where none is active.
const VersionRow* version_before_active(const std::vector<VersionRow>& versions) {
  const VersionRow* previous = nullptr;
  for (const VersionRow& row : versions) {  // ascending
    if (row.active) return previous;
    if (!row.damage) previous = &row;
  }
  return previous;
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return {text, length};
}

void raise_generation(const Database& database) {
  database.execute("UPDATE setting SET value = value + 1 WHERE name = 'generation'");
}

void validate_landmark(const Landmark& landmark) {
  validate_name(landmark.name, "landmark name");
  for (int axis = 0; axis < 3; ++axis) {
    // Written so that a NaN is refused too.
    const bool finite =
        std::abs(landmark.min_m[axis]) < 1e300 && std::abs(landmark.max_m[axis]) < 1e300;
    if (!finite || !(landmark.min_m[axis] < landmark.max_m[axis])) {
      throw Error(ErrorCode::kInvalidArgument,
                  "the box of landmark '" + landmark.name + "' runs from " +
                      std::to_string(landmark.min_m[axis]) + " to " +
                      std::to_string(landmark.max_m[axis]) + " along " + "xyz"[axis] +
                      ", want a minimum below the maximum",
                  "box");
    }
  }
}

InsertResult insert_version(const Database& database,
                            const std::string& name,
                            const Segment& segment,
                            const SceneExtras& extras,
                            const RunContext& context,
                            const SceneDeriver& deriver) {
  validate_name(name, "scene name");
  for (const auto& [key, value] : extras.tags) {
    validate_name(key, "tag key");
    validate_tag_value(value);
  }
  for (const Landmark& landmark : extras.landmarks) validate_landmark(landmark);

  const std::optional<SceneIndexBlob> index = derive_scene_index(segment, deriver, context);
  Transaction transaction(database, kWrite);
  InsertResult result;
  result.scene_id = make_scene(database, name);
  result.version = next_version(database, result.scene_id);
  const std::int64_t segment_id = write_segment(database, segment, context);
  if (index) write_scene_index(database, segment_id, segment.sha256, *index);
  const std::string now = utc_now();
  Statement insert(database,
                   "INSERT INTO scene_version (scene_id, version, segment_id, state, created, "
                   "kind, points, keypoints, voxel_m, normal_radius_m, shot_radius_m, "
                   "keypoint_spacing_m, keypoint_method, sources, warnings) "
                   "VALUES (?, ?, ?, 'building', ?, '', 0, 0, 0, 0, 0, 0, '', '', '')");
  insert.bind(result.scene_id).bind(result.version).bind(segment_id).bind(now);
  insert.run();
  write_version_columns(database, result.scene_id, result.version, columns_of(segment.manifest));
  activate(database, result.scene_id, result.version);
  for (const auto& [key, value] : extras.tags) write_tag(database, result.scene_id, key, value);
  for (const Landmark& landmark : extras.landmarks) {
    write_landmark(database, result.scene_id, landmark);
  }
  raise_generation(database);
  result.generation = read_generation(database);
  context.check("store");
  transaction.commit();
  return result;
}

void remove_scene(const Database& database, std::string_view name) {
  Transaction transaction(database, kWrite);
  const std::int64_t scene_id = require_scene_id(database, name);
  for (const VersionRow& row : read_versions(database, scene_id)) delete_version(database, row);
  Statement remove(database, "DELETE FROM scene WHERE id = ?");
  remove.bind(scene_id);
  remove.run();
  raise_generation(database);
  transaction.commit();
}

void rename_scene(const Database& database, std::string_view old_name, std::string_view new_name) {
  validate_name(new_name, "scene name");
  Transaction transaction(database, kWrite);
  const std::int64_t scene_id = require_scene_id(database, old_name);
  const std::optional<std::int64_t> taken = find_scene_id(database, new_name);
  if (taken && *taken != scene_id) {
    throw Error(ErrorCode::kAlreadyExists,
                "there is already a scene '" + std::string(new_name) + "'; '" +
                    std::string(old_name) + "' keeps its name",
                "name");
  }
  Statement update(database, "UPDATE scene SET name = ? WHERE id = ?");
  update.bind(new_name).bind(scene_id);
  update.run();
  raise_generation(database);
  transaction.commit();
}

bool can_roll_back(const Database& database, std::int64_t scene_id) {
  const std::vector<VersionRow> versions = read_versions(database, scene_id);
  return version_before_active(versions) != nullptr;
}

std::int64_t rollback_scene(const Database& database, std::string_view name) {
  Transaction transaction(database, kWrite);
  const std::int64_t scene_id = require_scene_id(database, name);
  const std::vector<VersionRow> versions = read_versions(database, scene_id);
  const VersionRow* previous = version_before_active(versions);
  if (previous == nullptr) {
    throw Error(ErrorCode::kFailedPrecondition,
                "scene '" + std::string(name) + "' has no earlier version to go back to",
                "scene");
  }
  activate(database, scene_id, previous->version);
  raise_generation(database);
  transaction.commit();
  return previous->version;
}

void set_tag(const Database& database,
             std::string_view name,
             std::string_view key,
             std::string_view value) {
  change_tags(database, name, {{std::string(key), std::string(value)}});
}

void remove_tag(const Database& database, std::string_view name, std::string_view key) {
  change_tags(database, name, {{std::string(key), std::nullopt}});
}

void change_tags(const Database& database, std::string_view name, const TagChanges& changes) {
  for (const auto& [key, value] : changes) {
    if (!value) continue;  // a tag that is there may be taken away whatever its key
    validate_name(key, "tag key");
    validate_tag_value(*value);
  }
  Transaction transaction(database, kWrite);
  const std::int64_t scene_id = require_scene_id(database, name);
  for (const auto& [key, value] : changes) {
    if (value) {
      write_tag(database, scene_id, key, *value);
    } else {
      delete_tag(database, scene_id, name, key);
    }
  }
  raise_generation(database);
  transaction.commit();
}

void set_landmark(const Database& database, std::string_view name, const Landmark& landmark) {
  validate_landmark(landmark);
  Transaction transaction(database, kWrite);
  write_landmark(database, require_scene_id(database, name), landmark);
  raise_generation(database);
  transaction.commit();
}

void remove_landmark(const Database& database, std::string_view name, std::string_view landmark) {
  Transaction transaction(database, kWrite);
  Statement remove(database, "DELETE FROM landmark WHERE scene_id = ? AND name = ?");
  remove.bind(require_scene_id(database, name)).bind(landmark);
  remove.run();
  if (database.changed_rows() == 0) {
    throw Error(ErrorCode::kNotFound,
                "scene '" + std::string(name) + "' has no landmark '" + std::string(landmark) + "'",
                "landmark");
  }
  raise_generation(database);
  transaction.commit();
}

std::vector<std::string> drop_old_versions(const Database& database) {
  std::vector<std::string> dropped;
  Transaction transaction(database, kWrite);
  for (const SceneSummary& scene : read_summaries(database)) {
    if (scene.active_version == 0) continue;  // damaged: nothing of it is let go
    const std::vector<VersionRow> versions = read_versions(database, scene.id);
    const VersionRow* previous = version_before_active(versions);
    for (const VersionRow& row : versions) {
      if (row.active || &row == previous) continue;
      delete_version(database, row);
      dropped.push_back(row.what() + " was dropped");
    }
  }
  if (!dropped.empty()) raise_generation(database);
  transaction.commit();
  return dropped;
}

}  // namespace landmarkdb
