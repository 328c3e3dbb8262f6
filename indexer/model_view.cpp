#include "indexer/model_view.hpp"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "engine/mono/feature_names.hpp"
#include "engine/mono/read_model.hpp"
#include "indexer/scene_view.hpp"

namespace landmarkdb::indexer {
namespace {

using cli::Align;
using nlohmann::ordered_json;

std::string metres_text(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", metres);
  return text;
}

std::string place_text(const Eigen::Vector3d& v) {
  return metres_text(v.x()) + ' ' + metres_text(v.y()) + ' ' + metres_text(v.z());
}

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

ordered_json model_json(const ModelSummary& summary, const MonoModel& model) {
  ordered_json object = model_json(summary);
  object["model"] = ordered_json::parse(model_to_json(model));
  return object;
}

std::string models_text(const std::vector<ModelSummary>& models) {
  if (models.empty()) return "no models\n";
  cli::Table table({{"NAME"},
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
               cli::count_text(model.points),
               cli::count_text(model.edges),
               cli::count_text(model.faces),
               cli::count_text(model.circles),
               cli::count_text(model.triples),
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
  return text + counted(model.triples, "triple") + ", symmetry " + model.symmetry + ", " +
         metres_text(model.diameter_m) + " m across";
}

std::string model_text(const ModelSummary& summary, const MonoModel& model) {
  std::string text = cli::printable(summary.name) + ": " + model_figures(summary) + "\n";
  text += "from " + cli::printable(summary.source) + ", stored " + summary.created + "\n";
  if (summary.damage) text += "damaged, not served: " + cli::printable(*summary.damage) + "\n";
  for (const std::string& warning : summary.warnings) {
    text += "note: " + cli::printable(warning) + "\n";
  }
  cli::Table table({{"POINT", Align::kRight}, {"TYPE"}, {"X Y Z (m)"}, {"NORMAL"}});
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const ModelFeature& p = model.points[i];
    table.add({std::to_string(i),
               std::string(feature_type_name(p.type)),
               place_text(p.xyz),
               p.normal ? place_text(*p.normal) : "-"});
  }
  return text + '\n' + table.text();
}

}  // namespace landmarkdb::indexer
