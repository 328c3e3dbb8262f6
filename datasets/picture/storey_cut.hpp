#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb::datasets {

// The heights between which a plan shows a storey.
struct StoreyCut {
  float floor_m = 0.0F;  // just below the floor
  float top_m = 0.0F;    // below the ceiling, above most furniture
};

// Finds floor and ceiling of the storey around `sensor` from the heights (z up) where most points
// lie below and above it.
StoreyCut find_storey(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& sensor);

// The turn about z that lays most of the place's extent along x: of the smallest box around it seen
// from above. Radians, in (-pi/2, pi/2].
double straighten_rad(std::span<const Eigen::Vector3f> points);

// Takes out points that hang in the air by themselves, where clouds are dense enough to tell: mixed
// pixels hide what lies below them. Keeps the order of the rest.
void drop_strays(std::vector<Eigen::Vector3f>& points);

}  // namespace landmarkdb::datasets
