#pragma once

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Holds the poses of places against one another, point by point. Two poses in a room have floor and
// walls in common, and their scores lie close together whatever the rest says; so only the query's
// points that fit better under one of the two are counted. Fills `Assessed::id` and
// `Assessed::contrast`: (for - against) / (for + against), 1 where all that tells the two apart
// speaks for the pose, -1 where it speaks for the other, near 0 where nothing does (the sign test
// of McNemar 1947, soft); and `Assessed::closeness`, which tells slides of a few centimetres that
// both explain the query. Poses of objects are left without.
void contrast_poses(const SearchInput& input, SearchResult& result);

}  // namespace landmarkdb
