#pragma once

#include "engine/mono/edge_chains.hpp"
#include "engine/mono/split_chain.hpp"

namespace landmarkdb {

// Of the last chain, one without a point of high contrast, only what runs straight stays: the
// outlines of faint faces do, uneven light and noise seldom. The chain is taken off, and the runs
// of neighbouring straight pieces of 12 px and more come in its place, each a chain that is not
// closed; there may be none.
void keep_straight_runs(EdgeChains& chains, ChainSplitter& splitter);

}  // namespace landmarkdb
