#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/types/model_summary.hpp"

namespace landmarkdb::cli {

// Models as the indexer and the client print them: the same keys for scripts, the same lines for
// people.

nlohmann::ordered_json model_json(const ModelSummary& model);
// A line a model; "no models" without any.
std::string models_text(const std::vector<ModelSummary>& models);
// "8 points, 12 edges, 6 faces, 56 triples, symmetry none, 0.1562 m across"
std::string model_figures(const ModelSummary& model);
// Figures, source, damage and warnings.
std::string model_text(const ModelSummary& model);

// Four digits.
std::string metres_text(double metres);

}  // namespace landmarkdb::cli
