#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "client/tracking.hpp"

namespace landmarkdb::client {

// One line of `track`: the documented keys in the documented order; `name` is the frame's.
// Transforms are 16 numbers row by row or null, lengths metres, angles radians but where the name
// ends in `_deg`.
nlohmann::ordered_json track_json(const std::string& name, const TrackedFrame& frame);

// The line of a frame that could not be used.
nlohmann::ordered_json unusable_frame_json(const std::string& name, const std::string& reason);

}  // namespace landmarkdb::client
