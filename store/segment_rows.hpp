#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/segment.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

inline constexpr std::size_t kChunkBytes = std::size_t{4} << 20U;

// Writes a segment in chunks and returns its id; within the caller's transaction. Reports the stage
// "store" in bytes before each chunk.
std::int64_t write_segment(const sqlite::Database& database,
                           const Segment& segment,
                           const RunContext& context);

// Reads a segment and checks every digest; the arrays that `parts` leaves out stay empty. Nothing
// is allocated before the stored lengths agree with the manifest. Throws Error{kDataLoss} beginning
// with `what`. Within the caller's transaction.
Segment read_segment(const sqlite::Database& database,
                     std::int64_t segment_id,
                     const std::string& what,
                     const RunContext& context,
                     SceneParts parts = SceneParts::kWhole);

// What is wrong with each array of a segment of this manifest, in its order. `bytes` grows by what
// was read whole. Throws what `context.check` does.
std::vector<std::string> array_faults(const sqlite::Database& database,
                                      std::int64_t segment_id,
                                      const Manifest& manifest,
                                      const std::string& what,
                                      const RunContext& context,
                                      std::uint64_t& bytes);

// The manifest alone, with its digest checked.
Manifest read_manifest(const sqlite::Database& database,
                       std::int64_t segment_id,
                       const std::string& what);

void delete_segment(const sqlite::Database& database, std::int64_t segment_id);

}  // namespace landmarkdb
