#pragma once

#include <Eigen/Core>

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Whether a pose agrees with what the asker knows; refinement and the paper's search do not look
// at it. Each is true where nothing is known.
bool agrees_with_up(const Assessed& pose, const SceneRecord& record, const QueryOptions& options);
bool agrees_with_prior(const Assessed& pose,
                       const SceneRecord& record,
                       const CleanQuery& query,
                       const QueryOptions& options);

// Where the sensor stands under the pose, scene frame.
Eigen::Vector3d sensor_position(const Assessed& pose,
                                const SceneRecord& record,
                                const CleanQuery& query);

// Drops the poses that contradict what the asker knows; returns the dropped ones.
std::vector<Assessed> keep_expected(const SearchInput& input, std::vector<Assessed>& poses);

}  // namespace landmarkdb
