#pragma once

#include <cstddef>
#include <span>

#include "engine/base/run_context.hpp"
#include "engine/mono/candidate_pool.hpp"
#include "engine/mono/four_index.hpp"
#include "engine/mono/image_fours.hpp"
#include "engine/mono/image_view.hpp"

namespace landmarkdb {

struct FourSearchOptions {
  double min_depth_m = 0.05, max_depth_m = 20.0;
  std::span<const char> wanted{};  // by model: search it
};

// Method A for fours (Huttenlocher & Ullman 1990): each four of linked image points is held for
// each four of the models with the same types and links; those that pass the test of orthography,
// best first, give a pose for the pool.
//
// Work is bounded: false where pairs or poses were left out for it. Throws what run.check throws.
bool search_by_fours(std::span<const SearchModel> models,
                     const FourIndex& index,
                     const ImageView& image,
                     std::span<const ImageFour> fours,
                     const FourSearchOptions& options,
                     const RunContext& run,
                     CandidatePool& pool);

}  // namespace landmarkdb
