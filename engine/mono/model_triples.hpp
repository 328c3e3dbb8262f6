#pragma once

#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// A triple whose largest side is L is collinear, and never made, when |e1 x e2| < this times L^2.
inline constexpr double kCollinearTriple = 1e-3;
// More are not made of one model: the linked ones come first.
inline constexpr std::size_t kMaxModelTriples = 20'000;

// The triples of a model that recognition by alignment draws from, sorted by their points.
//
// Linked triples: a junction i0 and two points that edges join it with. Face triples: three corners
// of one face, once, the junction its lowest. A triple that is both is one. Their views are those
// of visibility.hpp along model_views(). Throws what `context.check` throws.
//
// Cost: 256 views of all points, and O(sum of degree^2 + corners^3).
std::vector<ModelTriple> make_triples(const MonoModel& model, const RunContext& context = {});

// The record of three points (the first the junction); false when they are collinear, and then
// `triple` has only its points and lengths.
bool make_triple(const MonoModel& model, ModelTriple& triple);

}  // namespace landmarkdb
