#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/types/mono_model.hpp"
#include "store/model_types.hpp"

// How models look from outside: JSON for scripts (the keys are the client's), tables for people.
namespace landmarkdb::indexer {

nlohmann::ordered_json model_json(const ModelSummary& model);
// With its points, edges, faces, circles and symmetries.
nlohmann::ordered_json model_json(const ModelSummary& summary, const MonoModel& model);

std::string models_text(const std::vector<ModelSummary>& models);
std::string model_text(const ModelSummary& summary, const MonoModel& model);

// "14 points, 12 edges, 6 faces, 24 triples, symmetry cube, 0.145 m across"
std::string model_figures(const ModelSummary& model);

}  // namespace landmarkdb::indexer
