#include "cli/model_view.hpp"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "engine/types/feature_names.hpp"

namespace landmarkdb::cli {
namespace {

using nlohmann::ordered_json;

ordered_json types_json(const ModelSummary& model) {
  ordered_json types = ordered_json::object();
  for (std::size_t i = 0; i < kFeatureTypes; ++i) {
    types[std::string(kFeatureTypeNames[i])] = model.points_of_type[i];
  }
  return types;
}

}  // namespace

ordered_json model_json(const ModelSummary& model) {
  ordered_json object = {{"name", model.name},
                         {"model_id", model.id},
                         {"state", model.damage ? "quarantined" : "active"},
                         {"created", model.created},
                         {"source", model.source},
                         {"unit_scale", model.unit_scale},
                         {"points", model.points},
                         {"points_of_type", types_json(model)},
                         {"edges", model.edges},
                         {"faces", model.faces},
                         {"circles", model.circles},
                         {"triples", model.triples},
                         {"symmetry", model.symmetry},
                         {"symmetries", model.symmetries},
                         {"diameter_m", model.diameter_m},
                         {"warnings", model.warnings},
                         {"sha256", model.sha256}};
  if (model.damage) object["state_reason"] = *model.damage;
  return object;
}

std::string models_text(const std::vector<ModelSummary>& models) {
  if (models.empty()) return "no models\n";
  Table table({{"NAME"},
               {"POINTS", Align::kRight},
               {"EDGES", Align::kRight},
               {"FACES", Align::kRight},
               {"CIRCLES", Align::kRight},
               {"TRIPLES", Align::kRight},
               {"SYMMETRY"},
               {"ACROSS (m)", Align::kRight},
               {"CREATED"},
               {"STATE"}});
  for (const ModelSummary& model : models) {
    table.add({model.name,
               count_text(model.points),
               count_text(model.edges),
               count_text(model.faces),
               count_text(model.circles),
               count_text(model.triples),
               model.symmetry,
               metres_text(model.diameter_m),
               model.created,
               model.damage ? "damaged" : "active"});
  }
  return table.text();
}

std::string model_figures(const ModelSummary& model) {
  std::string text = counted(model.points, "point") + ", " + counted(model.edges, "edge") + ", " +
                     counted(model.faces, "face") + ", ";
  if (model.circles > 0) text += counted(model.circles, "circle") + ", ";
  return text + counted(model.triples, "triple") + ", symmetry " + printable(model.symmetry) +
         ", " + metres_text(model.diameter_m) + " m across";
}

std::string model_text(const ModelSummary& model) {
  std::string text = printable(model.name) + ": " + model_figures(model) + "\n";
  text += "from " + printable(model.source) + ", stored " + printable(model.created) + "\n";
  if (model.damage) text += "damaged, not served: " + printable(*model.damage) + "\n";
  for (const std::string& warning : model.warnings) text += "note: " + printable(warning) + "\n";
  return text;
}

std::string metres_text(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", metres);
  return text;
}

}  // namespace landmarkdb::cli
