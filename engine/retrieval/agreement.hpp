#pragma once

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// A correspondence agrees with a pose when its keypoints fall this close: keypoints are one in
// three voxels.
inline constexpr double kInlierCells = 3.0;

// Counts for each pose the query's keypoints of which a descriptor pair agrees with it:
// what the descriptors say, beside what the surface does. Fills `evidence.agreeing`.
void count_agreeing(const SearchInput& input, SearchResult& result);

}  // namespace landmarkdb
