#pragma once

#include <cstddef>

#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// A judged pose as the answer states it: scene frame (with the entry's origin), chain, counts,
// landmark, covariance. `result` is the search it came from.
Hypothesis make_hypothesis(const Judged& judged,
                           const SearchInput& input,
                           const SearchResult& result);

// Every putative pair of the pose's entry with what became of it.
std::vector<CorrespondenceRecord> list_correspondences(const Judged& judged,
                                                       const SearchInput& input,
                                                       const SearchResult& result);

}  // namespace landmarkdb
