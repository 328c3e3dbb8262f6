#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/manifest.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// Reads of the scene tables; each within the caller's transaction.

// Where one version lies.
struct VersionRow {
  std::int64_t scene_id = 0;
  std::string scene;
  std::int64_t version = 0;
  std::int64_t segment_id = 0;
  bool active = false;
  std::optional<std::string> damage{};
  std::string sha256{};  // of the segment; empty where that is lost

  std::string what() const;  // "scene 'lobby' version 2", for messages
};

std::uint64_t read_generation(const sqlite::Database& database);
std::optional<std::int64_t> find_scene_id(const sqlite::Database& database, std::string_view name);
// Throws Error{kNotFound} naming the scene.
std::int64_t require_scene_id(const sqlite::Database& database, std::string_view name);
std::string require_scene_name(const sqlite::Database& database, std::int64_t scene_id);

// All versions, or those of one scene, by scene and version.
std::vector<VersionRow> read_versions(const sqlite::Database& database,
                                      std::optional<std::int64_t> scene_id = std::nullopt);
// The version asked for, or the active one; Error{kNotFound}.
VersionRow require_version_row(const sqlite::Database& database,
                               std::int64_t scene_id,
                               std::optional<std::int64_t> version);

SceneSummary read_summary(const sqlite::Database& database, std::int64_t scene_id);
std::vector<SceneSummary> read_summaries(const sqlite::Database& database);
std::map<std::string, std::string> read_tags(const sqlite::Database& database,
                                             std::int64_t scene_id);
std::vector<Landmark> read_landmarks(const sqlite::Database& database, std::int64_t scene_id);

// True when the columns of scene_version that repeat the manifest say what it says.
bool columns_agree(const sqlite::Database& database,
                   const VersionRow& row,
                   const Manifest& manifest);

}  // namespace landmarkdb
