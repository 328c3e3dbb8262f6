#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/types/model_summary.hpp"
#include "engine/types/mono_model.hpp"

// How one model looks from outside, with all it holds: JSON for scripts, a table for people.
namespace landmarkdb::indexer {

// cli/model_view.hpp with its points, edges, faces, circles and symmetries.
nlohmann::ordered_json model_json(const ModelSummary& summary, const MonoModel& model);

std::string model_text(const ModelSummary& summary, const MonoModel& model);

}  // namespace landmarkdb::indexer
