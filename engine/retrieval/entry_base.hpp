#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/level.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// What of a catalogue is in memory from the start: objects and the places of levels that are
// scanned whole, of others their outlines with keypoints.
struct EntryBase {
  std::vector<std::shared_ptr<const Entry>> entries;  // as in the catalogue
  std::vector<std::string> damage;                    // of each; empty where it is sound
  std::vector<std::optional<EntryCodes>> codes;       // of each, where they were read
};

// Reads it, side by side. Throws what reading throws but for damage, and what `context` does.
EntryBase make_entry_base(const Catalog& catalog,
                          std::size_t most_scanned_rows,
                          const RunContext& context);

}  // namespace landmarkdb
