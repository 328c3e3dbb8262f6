#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/mono/candidate_pool.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/edge_outline.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {

// What the search by corners asks of a model again and again.
struct CornerModel {
  // Its triples that stand on two edges, one of each set that its symmetries carry onto each other
  // (a cube has one).
  std::vector<ModelTriple> corners;
  std::optional<EdgeOutline> outline;  // where there are corners
};

CornerModel prepare_corners(const SearchModel& model);

struct CornerSearchOptions {
  double min_depth_m = 0.05, max_depth_m = 20.0;
  std::span<const char> wanted;  // by model
  double scale = 1.0;            // of the pixel tolerances: those of a 640 pixels wide image
};

// Looks for boxy models by alignment (Huttenlocher & Ullman 1990): two edges of the image that
// meet, with their far ends, are held for two edges of the model; each weak-perspective pose is
// asked how much of the model's outline lies on edges of the image, and the best are drawn onto
// them and put to the pool's test. Finds what shows too few corners for the votes of fours.
//
// `corner_models`: as many as `models`, each of the model in its place.
// False when there was more to look at than the limits allow. Throws what `run.check` does.
bool search_by_corners(std::span<const SearchModel> models,
                       std::span<const CornerModel> corner_models,
                       const ImageFeatures& features,
                       const Camera& camera,
                       const EdgeGrid& edges,
                       const CornerSearchOptions& options,
                       const RunContext& run,
                       CandidatePool& pool);

}  // namespace landmarkdb
