#pragma once

#include "engine/geometry/camera.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// Each visible edge takes the line of the image near it that most of it lies on, with one bright
// side; lines that meet in a corner then agree on where that is. `scale`: of the pixel tolerances,
// which are those of an image 640 pixels wide. 0.1 ms.
void judge_lines(const SearchModel& model,
                 const Camera& camera,
                 const RigidPose& pose,
                 const EdgeGrid& grid,
                 double scale,
                 EdgeEvidence& evidence);

}  // namespace landmarkdb
