#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "client/recognition.hpp"

namespace landmarkdb::client {

// Reads feature points: JSON {"points": [{"type": "vertex", "uv": [u, v], "directions": [rad,
// ...]?},
// ...], "links": [[i, j], ...]?}, pixels; a point without a type is a vertex. Fills `input.points`
// and `input.links`. Throws Error{kInvalidArgument} that names the file, the point, what was seen
// and what was wanted.
void read_points(const std::filesystem::path& path, RecognizeInput& input);

// The same for a file in memory; `name` is what messages call it.
void parse_points(std::string_view text, const std::string& name, RecognizeInput& input);

// The same for what has been parsed.
void take_points(const nlohmann::json& json, const std::string& name, RecognizeInput& input);

}  // namespace landmarkdb::client
