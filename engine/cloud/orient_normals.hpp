#pragma once

#include <span>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/cloud/spatial_index.hpp"

namespace landmarkdb {

// Turns unit normals so that neighbours agree, where nothing is known about the sensor.
//
// Signs travel along a minimum spanning tree of the neighbour graph, whose edges are the cheaper
// the more parallel their normals are (Hoppe et al. 1992). The tree leaves one sign a connected
// part open: a part up to the size of an object that bulges gets normals that point away from its
// own centre; any other gets normals that point to the centre of the scene, as rooms and streets
// are seen from within, or away from it when the scene itself is no larger than an object. Zero
// normals stay zero.
void orient_consistently(std::span<const Eigen::Vector3f> points,
                         std::span<Eigen::Vector3f> normals,
                         const SpatialIndex& index,
                         const RunContext& context);

}  // namespace landmarkdb
