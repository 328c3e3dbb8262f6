#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/segment.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// Changes of the scene tables, each in a transaction of its own that also raises the generation.

// What is stored beside a scene's versions.
struct SceneExtras {
  std::map<std::string, std::string> tags;
  std::vector<Landmark> landmarks;
};

// Adds a version of the scene `name` (made where there is none) and activates it; `extras` are
// added to what the scene has, what `deriver` makes is stored with the version.
InsertResult insert_version(const sqlite::Database& database,
                            const std::string& name,
                            const Segment& segment,
                            const SceneExtras& extras,
                            const RunContext& context,
                            const SceneDeriver& deriver = {});

void remove_scene(const sqlite::Database& database, std::string_view name);
void rename_scene(const sqlite::Database& database,
                  std::string_view old_name,
                  std::string_view new_name);
// Whether there is a version that it could go back to.
bool can_roll_back(const sqlite::Database& database, std::int64_t scene_id);
std::int64_t rollback_scene(const sqlite::Database& database, std::string_view name);

void set_tag(const sqlite::Database& database,
             std::string_view name,
             std::string_view key,
             std::string_view value);
void remove_tag(const sqlite::Database& database, std::string_view name, std::string_view key);
// Sets the tags that have a value and takes away those that have none; all or nothing.
void change_tags(const sqlite::Database& database,
                 std::string_view name,
                 const TagChanges& changes);
void set_landmark(const sqlite::Database& database,
                  std::string_view name,
                  const Landmark& landmark);
void remove_landmark(const sqlite::Database& database,
                     std::string_view name,
                     std::string_view landmark);

// Drops the versions that neither serve nor would be rolled back to; a sentence for each.
std::vector<std::string> drop_old_versions(const sqlite::Database& database);

// Throws Error{kInvalidArgument} for a bad name or a box without a volume.
void validate_landmark(const Landmark& landmark);

// Within the caller's transaction.
void raise_generation(const sqlite::Database& database);
// Now, in UTC: "2024-05-01T12:00:00Z".
std::string utc_now();

}  // namespace landmarkdb
