#include "bench/retrieval/real_cases.hpp"

#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {

namespace {

nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::kInvalidArgument, "cannot read " + path.string());
  return nlohmann::json::parse(file);
}

std::vector<std::filesystem::path> paths_of(const std::filesystem::path& folder,
                                            const nlohmann::json& names) {
  std::vector<std::filesystem::path> paths;
  for (const auto& name : names) paths.push_back(folder / name.get<std::string>());
  return paths;
}

RealCase case_of(const std::filesystem::path& folder, const nlohmann::json& row) {
  RealCase one;
  one.id = row.at("id");
  one.kind = row.at("kind");
  one.query = folder / row.at("query").get<std::string>();
  one.targets = paths_of(folder, row.at("target"));
  if (row.contains("database")) one.database = paths_of(folder, row.at("database"));
  if (row.at("T_target_query").is_array()) {
    const auto numbers = row.at("T_target_query").get<std::array<double, 16>>();
    one.T_target_query = from_row_major(numbers);
    one.accuracy_m = row.value("truth_accuracy_m", 0.0);
    one.accuracy_rad = row.value("truth_accuracy_deg", 0.0) * std::numbers::pi / 180.0;
  }
  return one;
}

}  // namespace

RealData read_real_data(const std::filesystem::path& folder) {
  RealData data;
  const nlohmann::json database = read_json(folder / "database.json");
  data.places = paths_of(folder, database.at("scene"));
  data.objects = paths_of(folder, database.at("object"));
  for (const auto& row : read_json(folder / "cases.json")) {
    if (row.at("kind") == "monocular") continue;
    data.cases.push_back(case_of(folder, row));
  }
  return data;
}

}  // namespace landmarkdb::bench
