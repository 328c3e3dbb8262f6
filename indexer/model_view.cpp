#include "indexer/model_view.hpp"

#include <nlohmann/json.hpp>

#include "cli/model_view.hpp"
#include "cli/table.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/types/feature_names.hpp"

namespace landmarkdb::indexer {
namespace {

using cli::Align;
using nlohmann::ordered_json;

std::string place_text(const Eigen::Vector3d& v) {
  return cli::metres_text(v.x()) + ' ' + cli::metres_text(v.y()) + ' ' + cli::metres_text(v.z());
}

}  // namespace

ordered_json model_json(const ModelSummary& summary, const MonoModel& model) {
  ordered_json object = cli::model_json(summary);
  object["model"] = ordered_json::parse(model_to_json(model));
  return object;
}

std::string model_text(const ModelSummary& summary, const MonoModel& model) {
  cli::Table table({{"POINT", Align::kRight}, {"TYPE"}, {"X Y Z (m)"}, {"NORMAL"}});
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    const ModelFeature& p = model.points[i];
    table.add({std::to_string(i),
               std::string(feature_type_name(p.type)),
               place_text(p.xyz),
               p.normal ? place_text(*p.normal) : "-"});
  }
  return cli::model_text(summary) + '\n' + table.text();
}

}  // namespace landmarkdb::indexer
