#pragma once

#include <cstddef>

#include "engine/retrieval/chain.hpp"
#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// A judged pose as the answer states it: scene frame (with the entry's origin), chain, counts,
// landmark, covariance. `result` is the search it came from.
Hypothesis make_hypothesis(const Judged& judged,
                           const SearchInput& input,
                           const SearchResult& result);

// The chain behind a judged pose, and which of its entry's pairs agree with it.
ChainResult chain_of(const Judged& judged, const SearchInput& input, const EntryMatches& matches);

}  // namespace landmarkdb
