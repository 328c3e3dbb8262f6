#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "datasets/place.hpp"

namespace landmarkdb::datasets {

// Where a surveyor would put the scanner: `options.stations` free positions a floor, 1.6 m up, each
// as far from the others as the floor allows. The same positions on floors that are copies. Throws
// Error{kInvalidArgument} when a floor has no free position.
std::vector<Eigen::Isometry3d> choose_stations(const Place& place);

}  // namespace landmarkdb::datasets
