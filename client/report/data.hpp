#pragma once

#include <nlohmann/json_fwd.hpp>

#include "client/report/drawing.hpp"

namespace landmarkdb::client {

// What the page's program reads: points as base64 of 16-bit numbers, everything else as numbers.
nlohmann::ordered_json drawing_json(const Drawing& drawing);

}  // namespace landmarkdb::client
