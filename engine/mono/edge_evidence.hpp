#pragma once

#include "engine/geometry/camera.hpp"
#include "engine/mono/edge_grid.hpp"
#include "engine/mono/rigid_pose.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

// How a model's edges at a pose lie on the image's. `scale`: of the pixel tolerances, which are
// those of an image 640 pixels wide. 0.1 ms.
EdgeEvidence judge_edges(const SearchModel& model,
                         const Camera& camera,
                         const RigidPose& pose,
                         const EdgeGrid& grid,
                         double scale);

}  // namespace landmarkdb
