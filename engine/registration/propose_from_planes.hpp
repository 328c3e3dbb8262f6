#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/registration/plane_layout.hpp"
#include "engine/registration/propose.hpp"

namespace landmarkdb {

// Poses that lay the planes of one cloud onto those of another: the 24 rotations that turn one
// frame of right angles into the other, and along each direction the shifts at which most of the
// source's planes meet planes of the target facing the same way. Where the source has hardly a
// plane along one direction, shifts all along the target; where along two, nothing is proposed.
// Finds what no descriptor does: columns, walls and floor alone, at the price of every look-alike,
// so each is to be tested.
//
// `centre` (source frame) is kept within the target's bounds. Gravity and prior as in
// propose_from_frames. The proposals name no correspondence (kNoCorrespondence). Deterministic.
std::vector<Proposal> propose_from_planes(const PlaneLayout& target,
                                          const PlaneLayout& source,
                                          const Eigen::Vector3f& centre,
                                          const std::optional<Gravity>& gravity,
                                          const std::optional<PositionPrior>& prior);

}  // namespace landmarkdb
