#pragma once

#include <span>

#include "engine/base/run_context.hpp"
#include "engine/mono/candidate_pool.hpp"

namespace landmarkdb {

// Brings the best candidates to rest against what could be taken for them: the next places of a
// model that looks like itself there (a grid), the other tilt of a plane, and with the image's
// edges. The pool's candidates are sorted afterwards, best first, and few.
void settle_rivals(std::span<const SearchModel> models,
                   const ImageView& image,
                   const Camera& camera,
                   PoseCheck& check,
                   PoseCheck& mirrors,
                   CandidatePool& pool,
                   const RunContext& run);

}  // namespace landmarkdb
