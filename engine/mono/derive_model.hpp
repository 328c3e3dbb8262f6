#pragma once

#include "engine/base/run_context.hpp"
#include "engine/cloud/input.hpp"
#include "engine/mono/model_draft.hpp"

namespace landmarkdb {

// Checks a draft and fills in what can be derived, in this order:
//
// 1. points of one type at one place (a millionth of the diameter) become one, with a warning;
// 2. edges are unordered pairs, each once, ascending; without listed ones, the sides of all faces;
// 3. the faces of each closed part are turned outward; an open part is left as it is, and its faces
//    count as sheets, seen from both sides (visibility.hpp);
// 4. a circle has a kConicCentre, a face a kCentroid (unless the model lists any centroid itself);
//    where none lies there one is added behind the listed points. Their normals are those of the
//    circle and of the solid's face; a flat model is seen from both sides and gives none;
// 5. the diameter: the largest distance of two points, or of a circle;
// 6. symmetries and their class (model_symmetry.hpp); listed ones are kept, with a warning where
//    they do not map the points onto themselves.
//
// Throws Error{kInvalidArgument}: over a limit of read_model.hpp, a face without area or bent out
// of its plane by over a twentieth of the diameter, fewer than three points and no circle, points
// on one line and no circle; what `context.check` throws.
void derive_model(const Input& input, ModelDraft& draft, const RunContext& context);

}  // namespace landmarkdb
