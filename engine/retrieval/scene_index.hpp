#pragma once

#include <cstddef>
#include <optional>

#include "engine/base/run_context.hpp"
#include "engine/retrieval/place_outline.hpp"
#include "engine/types/descriptor_codes.hpp"
#include "engine/types/scene_record.hpp"
#include "engine/types/scene_source.hpp"

namespace landmarkdb {

// What is stored beside a scene so that a server of many need not read it whole: derived from it.
struct SceneIndex {
  DescriptorCodes codes;
  PlaceOutline outline;  // of objects: empty
};

// What of SceneIndexBlob this program writes and reads: its layout (schema/README.md) and how the
// codes are made. No bytes.
SceneIndexBlob scene_index_format();

// Of a record as it is read back, little-endian, with the format above.
SceneIndexBlob make_scene_index(const SceneRecord& record, const RunContext& context);

// The index again; nothing where it is of another format, or damaged, or not of `rows`
// descriptors, or where a place's has no keypoints for them. Without tails the blob needs none.
std::optional<SceneIndex> scene_index_from(const SceneIndexBlob& blob,
                                           EntryKind kind,
                                           std::size_t rows,
                                           bool with_tails);

// What is stored with an entry that has a source; nothing where there is none that is sound.
std::optional<SceneIndex> scene_index_of(const CatalogEntry& stored,
                                         bool with_tails,
                                         const RunContext& context);

}  // namespace landmarkdb
