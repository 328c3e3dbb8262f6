#include "store/scene_rows.hpp"

#include <utility>

#include "engine/base/error.hpp"
#include "store/version_columns.hpp"

namespace landmarkdb {
namespace {

using sqlite::Database;
using sqlite::Statement;

VersionSummary read_version_summary(const Statement& row) {
  VersionSummary version;
  version.version = row.integer(0);
  version.active = row.text(1) == "active";
  version.created = row.text(2);
  version.retired = row.text(3);
  version.points = static_cast<std::uint64_t>(row.integer(4));
  version.keypoints = static_cast<std::uint64_t>(row.integer(5));
  version.bytes = static_cast<std::uint64_t>(row.integer(6));
  version.sha256 = row.text(7);
  if (!row.is_null(8)) version.damage = row.text(8);
  return version;
}

std::vector<VersionSummary> read_version_summaries(const Database& database,
                                                   std::int64_t scene_id) {
  // A left join: a version whose segment is lost is still told.
  Statement rows(database,
                 "SELECT version, state, scene_version.created, retired, points, keypoints, "
                 "segment.bytes, segment.sha256, damage FROM scene_version "
                 "LEFT JOIN segment ON segment.id = segment_id WHERE scene_id = ? "
                 "ORDER BY version");
  rows.bind(scene_id);
  std::vector<VersionSummary> versions;
  while (rows.step()) versions.push_back(read_version_summary(rows));
  return versions;
}

void add_active_version(const Database& database, SceneSummary& scene) {
  for (const VersionSummary& version : scene.versions) {
    scene.bytes += version.bytes;
    if (!version.active) continue;
    scene.active_version = version.version;
    scene.points = version.points;
    scene.keypoints = version.keypoints;
    scene.damage = version.damage;
    const VersionColumns columns = read_version_columns(database, scene.id, version.version);
    scene.kind = kind_from_name(columns.kind).value_or(EntryKind::kPlace);
    scene.options = columns.options;
    scene.up = columns.up;
    scene.sources = texts_from_json(columns.sources);
    scene.warnings = texts_from_json(columns.warnings);
  }
  if (scene.active_version == 0) scene.damage = "no version is active";
}

}  // namespace

std::string VersionRow::what() const {
  return "scene '" + scene + "' version " + std::to_string(version);
}

std::uint64_t read_generation(const Database& database) {
  return static_cast<std::uint64_t>(
      database.integer("SELECT value FROM setting WHERE name = 'generation'"));
}

std::optional<std::int64_t> find_scene_id(const Database& database, std::string_view name) {
  Statement row(database, "SELECT id FROM scene WHERE name = ?");
  row.bind(name);
  if (!row.step()) return std::nullopt;
  return row.integer(0);
}

std::int64_t require_scene_id(const Database& database, std::string_view name) {
  const std::optional<std::int64_t> id = find_scene_id(database, name);
  if (!id) {
    throw Error(ErrorCode::kNotFound, "there is no scene '" + std::string(name) + "'", "scene");
  }
  return *id;
}

std::string require_scene_name(const Database& database, std::int64_t scene_id) {
  Statement row(database, "SELECT name FROM scene WHERE id = ?");
  row.bind(scene_id);
  if (!row.step()) {
    throw Error(
        ErrorCode::kNotFound, "there is no scene with id " + std::to_string(scene_id), "scene");
  }
  return row.text(0);
}

std::vector<VersionRow> read_versions(const Database& database,
                                      std::optional<std::int64_t> scene_id) {
  Statement rows(database,
                 "SELECT scene_id, name, version, segment_id, state, damage, segment.sha256 "
                 "FROM scene_version JOIN scene ON scene.id = scene_id "
                 "LEFT JOIN segment ON segment.id = segment_id "
                 "WHERE ?1 IS NULL OR scene_id = ?1 "
                 "ORDER BY scene_id, version");
  if (scene_id) {
    rows.bind(*scene_id);
  } else {
    rows.bind_null();
  }
  std::vector<VersionRow> versions;
  while (rows.step()) {
    VersionRow row{rows.integer(0), rows.text(1), rows.integer(2), rows.integer(3)};
    row.active = rows.text(4) == "active";
    if (!rows.is_null(5)) row.damage = rows.text(5);
    row.sha256 = rows.text(6);
    versions.push_back(std::move(row));
  }
  return versions;
}

VersionRow require_version_row(const Database& database,
                               std::int64_t scene_id,
                               std::optional<std::int64_t> version) {
  const std::string name = require_scene_name(database, scene_id);
  for (VersionRow& row : read_versions(database, scene_id)) {
    if (version ? row.version == *version : row.active) return std::move(row);
  }
  throw Error(ErrorCode::kNotFound,
              version ? "scene '" + name + "' has no version " + std::to_string(*version)
                      : "scene '" + name + "' has no active version",
              "scene");
}

std::map<std::string, std::string> read_tags(const Database& database, std::int64_t scene_id) {
  Statement rows(database, "SELECT key, value FROM tag WHERE scene_id = ?");
  rows.bind(scene_id);
  std::map<std::string, std::string> tags;
  while (rows.step()) tags[rows.text(0)] = rows.text(1);
  return tags;
}

std::vector<Landmark> read_landmarks(const Database& database, std::int64_t scene_id) {
  Statement rows(database,
                 "SELECT name, min_x_m, min_y_m, min_z_m, max_x_m, max_y_m, max_z_m "
                 "FROM landmark WHERE scene_id = ? ORDER BY name");
  rows.bind(scene_id);
  std::vector<Landmark> landmarks;
  while (rows.step()) {
    landmarks.push_back({rows.text(0),
                         {rows.real(1), rows.real(2), rows.real(3)},
                         {rows.real(4), rows.real(5), rows.real(6)}});
  }
  return landmarks;
}

SceneSummary read_summary(const Database& database, std::int64_t scene_id) {
  SceneSummary scene;
  scene.id = scene_id;
  scene.name = require_scene_name(database, scene_id);
  {
    Statement row(database, "SELECT created FROM scene WHERE id = ?");
    row.bind(scene_id);
    if (row.step()) scene.created = row.text(0);
  }
  scene.versions = read_version_summaries(database, scene_id);
  add_active_version(database, scene);
  scene.tags = read_tags(database, scene_id);
  scene.landmarks = read_landmarks(database, scene_id);
  return scene;
}

std::vector<SceneSummary> read_summaries(const Database& database) {
  std::vector<std::int64_t> ids;
  {
    Statement rows(database, "SELECT id FROM scene ORDER BY name");
    while (rows.step()) ids.push_back(rows.integer(0));
  }
  std::vector<SceneSummary> scenes;
  scenes.reserve(ids.size());
  for (const std::int64_t id : ids) scenes.push_back(read_summary(database, id));
  return scenes;
}

bool columns_agree(const Database& database, const VersionRow& row, const Manifest& manifest) {
  return read_version_columns(database, row.scene_id, row.version) == columns_of(manifest);
}

}  // namespace landmarkdb
