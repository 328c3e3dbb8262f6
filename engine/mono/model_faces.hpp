#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// Twice the area of a polygon times its unit normal (Newell): right also where it is not convex or
// not quite flat. Metres, counter-clockwise seen from where the normal points.
Eigen::Vector3d area_vector(const MonoModel& model, std::span<const std::uint32_t> face);

// The centre of gravity of a polygon's area.
Eigen::Vector3d area_centroid(const MonoModel& model, std::span<const std::uint32_t> face);

// The second moments of a polygon's area about its centre of gravity, divided by the area; zero
// where it has none. m2.
Eigen::Matrix3d area_spread(const MonoModel& model, std::span<const std::uint32_t> face);

// How far the furthest corner lies from the plane through the corners' mean, metres.
double out_of_plane_m(const MonoModel& model, std::span<const std::uint32_t> face);

}  // namespace landmarkdb
