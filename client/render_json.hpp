#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "engine/types/query.hpp"

namespace landmarkdb::client {

// The answer to `query --json`: the documented keys in the documented order; numbers read back to
// the same double. Transforms are 16 numbers row by row, lengths metres, angles radians but for
// `roll_pitch_yaw_deg`.
nlohmann::ordered_json query_json(const QueryResult& result);

// One line of text; what is not UTF-8 (a name from an old database) becomes U+FFFD.
std::string dump(const nlohmann::ordered_json& json);

// "localized", "ambiguous" or "not_found".
std::string_view status_name(QueryStatus status);

// 0, 4 or 3: what `landmarkdb query` ends with.
int query_exit_status(QueryStatus status);

}  // namespace landmarkdb::client
