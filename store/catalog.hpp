#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "engine/base/run_context.hpp"
#include "store/scene_rows.hpp"
#include "store/segment.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// Reads and verifies the segment or record of one version; within the caller's transaction.
// Failures that name the database only (a damaged page) come to name the version too.
Segment load_segment(const sqlite::Database& database,
                     const VersionRow& row,
                     const RunContext& context = {},
                     SceneParts parts = SceneParts::kWhole);
std::shared_ptr<const SceneRecord> load_record(const sqlite::Database& database,
                                               const VersionRow& row,
                                               const RunContext& context = {},
                                               SceneParts parts = SceneParts::kWhole);

// Store::load_catalog and load_outlines; a read transaction a scene.
enum class Loading { kWhole, kOutlines };
std::shared_ptr<const Catalog> load_catalog(const sqlite::Database& database,
                                            Loading loading,
                                            const RunContext& context,
                                            const OnDamaged& on_damaged,
                                            const Catalog* previous);

}  // namespace landmarkdb
