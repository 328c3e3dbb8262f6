#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/types/scene_source.hpp"
#include "store/scene_rows.hpp"
#include "store/segment.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// The table scene_index: what is derived from a segment's descriptors. Each within the caller's
// transaction.

bool has_scene_index(const sqlite::Database& database, std::int64_t segment_id);

// What is stored for the version, if its digests say that it is of this very segment and whole.
// Tails that are not wanted are neither read nor checked.
std::optional<SceneIndexBlob> read_scene_index(const sqlite::Database& database,
                                               const VersionRow& row,
                                               bool with_tails);

// The index of the segment's descriptors as `deriver` makes it; nothing without a maker, and for a
// scene whose index would be past what one row may hold.
std::optional<SceneIndexBlob> derive_scene_index(const Segment& segment,
                                                 const SceneDeriver& deriver,
                                                 const RunContext& context);

void write_scene_index(const sqlite::Database& database,
                       std::int64_t segment_id,
                       const std::string& segment_sha256,
                       const SceneIndexBlob& index);

// Makes the index of a sound version that has none, a damaged one, or one that is not as the
// deriver makes them; without a maker a damaged one is dropped. Says what was done, if anything.
std::optional<std::string> renew_scene_index(const sqlite::Database& database,
                                             const VersionRow& row,
                                             const SceneDeriver& deriver,
                                             const RunContext& context);

// The same for all versions not marked as damaged, a transaction each.
std::vector<std::string> renew_scene_indexes(const sqlite::Database& database,
                                             const RunContext& context,
                                             const SceneDeriver& deriver);

}  // namespace landmarkdb
