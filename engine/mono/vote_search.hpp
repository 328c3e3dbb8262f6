#pragma once

#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/candidate_pool.hpp"
#include "engine/mono/image_quads.hpp"
#include "engine/mono/image_view.hpp"
#include "engine/mono/quad_index.hpp"

namespace landmarkdb {

struct VoteOptions {
  double min_depth_m = 0.05, max_depth_m = 20.0;
  std::span<const char> wanted{};   // by model: search it
  std::size_t most_singles = 4000;  // single votes that are tried after the bins
};

// Method B: looks the image's quads up among those of all views of all models, lets each hit vote
// for a model, view, place, turn and depth, and tries poses from the fullest bins, then from single
// votes (Lang et al. 2010's codes; a Hough transform over poses). Passing poses go into the pool.
//
// Work is bounded: returns false where votes or trials were left out for it. Throws what run.check
// throws.
bool search_by_votes(std::span<const SearchModel> models,
                     const QuadIndex& index,
                     const ImageView& image,
                     std::span<const ImageQuad> quads,
                     const VoteOptions& options,
                     const RunContext& run,
                     CandidatePool& pool);

}  // namespace landmarkdb
