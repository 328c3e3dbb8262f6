#pragma once

#include <memory>
#include <optional>

#include "engine/mono/pose_check.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// The mirror image (x -> -x) of a model, as the search sees it. No catalogue holds it: it stands
// for the left-hand part where the right-hand one is known, and for all that looks like it.
// `tables` are the model's.
SearchModel prepare_mirror(const MonoModelRecord& record, const SearchTables& tables);

// Where the mirror image stands when it looks, from far away, as the model does at `pose`:
// reflected in the plane through the model's center that faces the camera. Front and back are
// exchanged, so that other points are seen, and under perspective they lie elsewhere by their
// depth.
RigidPose mirror_pose(const SearchModel& model, const RigidPose& pose);

// How much better the candidate explains the image than the mirror image of its model does, in
// log10 of false alarms; nullopt where the mirror image does not explain it at all. `mirrors`
// checks poses of the mirror images, in the order of the models.
std::optional<double> mirror_margin(const SearchModel& model,
                                    const MonoCandidate& candidate,
                                    PoseCheck& mirrors);

}  // namespace landmarkdb
