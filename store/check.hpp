#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/scene_rows.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// Store::check.
CheckReport check_database(const sqlite::Database& database, const RunContext& context);

// The parts of it that `repair` needs as well.

// SQLite's own integrity check: pages, indexes, constraints.
std::vector<std::string> integrity_findings(const sqlite::Database& database,
                                            const RunContext& context);
// What is wrong with a version's arrays; nothing where all digests, shapes and numbers are right.
// `bytes` grows by what was read.
std::optional<std::string> version_damage(const sqlite::Database& database,
                                          const VersionRow& row,
                                          std::uint64_t& bytes);

// Rows that nothing refers to, which a foreign key cannot tell.
inline constexpr const char* kOrphanSegments =
    "FROM segment WHERE id NOT IN (SELECT segment_id FROM scene_version)";
inline constexpr const char* kOrphanArrays =
    "FROM segment_array WHERE segment_id NOT IN (SELECT id FROM segment)";
inline constexpr const char* kOrphanChunks =
    "FROM segment_chunk WHERE array_id NOT IN (SELECT id FROM segment_array)";
inline constexpr const char* kOrphanIndexes =
    "FROM scene_index WHERE segment_id NOT IN (SELECT id FROM segment)";

}  // namespace landmarkdb
