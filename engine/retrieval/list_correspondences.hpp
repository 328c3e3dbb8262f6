#pragma once

#include <vector>

#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// What a list of pairs may take on the wire. The robust search pairs each keypoint with 60 and more
// neighbours, so that a whole turn of a laser has near a million.
inline constexpr std::size_t kMostCorrespondenceBytes = std::size_t{16} * 1024 * 1024;

struct CorrespondenceList {
  std::vector<CorrespondenceRecord> records;
  bool cut = false;  // some of the farther neighbours were left out
};

// The putative pairs of the answer's entry with what became of each: "" it agrees with the pose;
// "ratio", "slope", "clique" the filter that dropped it; "up", "prior" its local reference frames
// propose a pose that contradicts what was asked (robust search); "pose" it does not agree with the
// pose. Where nothing was found, of the entry that had most pairs left.
//
// All of them within kMostCorrespondenceBytes; otherwise those that agree, and of each keypoint as
// many of its nearest neighbours as there is room for.
CorrespondenceList list_correspondences(const Verdict& verdict,
                                        const SearchInput& input,
                                        const SearchResult& search);

}  // namespace landmarkdb
