#pragma once

#include <cstdint>

#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"
#include "engine/types/scene_view.hpp"

namespace landmarkdb {

// The surroundings of a judged pose, of at most `most` points (at least 1): what lies in the box of
// the query laid into the entry, padded by half its diagonal; of an object all of it.
SceneView make_scene_view(const Judged& judged,
                          const SearchInput& input,
                          const SearchResult& search,
                          std::uint32_t most);

}  // namespace landmarkdb
