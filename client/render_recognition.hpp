#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "client/recognition.hpp"

namespace landmarkdb::client {

// The answer to `recognize --json`: the documented keys in the documented order. Transforms are 16
// numbers row by row, lengths metres, angles radians but for `euler_zyx_deg` (about z, then y, then
// x: R = Rz Ry Rx).
nlohmann::ordered_json recognition_json(const RecognizeResult& result);
// The same in a few lines for people.
std::string recognition_text(const RecognizeResult& result);

// 0 recognized; 4 recognized, but a second pose or model explains the image about as well (the
// hypothesis says ambiguous, or its margin over the next is nothing); 3 not found.
int recognize_exit_status(const RecognizeResult& result);

// Models for scripts, as the indexer prints them; the first with the model itself where it has it.
nlohmann::ordered_json model_json(const ModelInfo& model);
nlohmann::ordered_json models_json(const std::vector<ModelSummary>& models);  // {"models": [...]}

}  // namespace landmarkdb::client
