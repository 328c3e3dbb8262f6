#pragma once

#include <string_view>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// What every detector and descriptor relies on: one normal a point, all finite. Throws
// Error{kInvalidArgument} that names the first point at fault. Detectors and PCL never see a NaN.
void check_cloud(const PreparedCloud& cloud, std::string_view stage);

// Throws Error{kInvalidArgument} unless `length_m` is positive and finite.
void check_length(double length_m, std::string_view name);

}  // namespace landmarkdb
