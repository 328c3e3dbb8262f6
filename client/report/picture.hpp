#pragma once

#include <string>

#include "client/report/drawing.hpp"

namespace landmarkdb::client {

enum class Aspect { kAbove, kSide };

// The best candidate's place and query as an inline SVG, with the sensor's frustum: what stands in
// the page where no program runs. Thousands of points, not all of them.
std::string static_picture(const Drawing& drawing, Aspect aspect);

}  // namespace landmarkdb::client
