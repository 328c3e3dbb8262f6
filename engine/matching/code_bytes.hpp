#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/types/descriptor_codes.hpp"
#include "engine/types/scene_source.hpp"

namespace landmarkdb {

// What of SceneIndexBlob this program writes and reads: its layout (schema/README.md) and how the
// codes are made. No bytes.
SceneIndexBlob code_format();

// The codes as bytes, little-endian, with the format above.
SceneIndexBlob bytes_of_codes(const DescriptorCodes& codes);

// What is stored beside a scene's descriptors (N x kShotLength, as they are read back).
SceneIndexBlob make_scene_index(const std::vector<float>& values, const RunContext& context);

// The codes again; nothing where they are of another format, or damaged, or not of `rows`
// descriptors.
std::optional<DescriptorCodes> codes_from(const SceneIndexBlob& blob, std::size_t rows);

}  // namespace landmarkdb
