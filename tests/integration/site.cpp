#include "tests/integration/site.hpp"

#include <sstream>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/cloud/write_cloud.hpp"

namespace landmarkdb::testing {

Outcome index_scene(const TempFolder& folder,
                    const std::string& db,
                    const std::string& name,
                    const SyntheticScene& scene) {
  std::vector<std::string> arguments = {"--db", db, "--json", "add", name};
  std::vector<std::string> viewpoints;
  for (std::size_t i = 0; i < scene.scans.size(); ++i) {
    const std::string path = folder / (name + "-" + std::to_string(i) + ".ply");
    write_cloud(path, scene.scans[i]);
    arguments.push_back(path);
    std::ostringstream viewpoint;
    const Eigen::Vector3f& from = scene.scans[i].viewpoints.front();
    viewpoint << from.x() << ',' << from.y() << ',' << from.z();
    viewpoints.insert(viewpoints.end(), {"--viewpoint", viewpoint.str()});
  }
  arguments.insert(arguments.end(), viewpoints.begin(), viewpoints.end());
  return run("landmarkdb-indexer", arguments);
}

SyntheticScene make_small_room(std::uint64_t seed) {
  return make_scene({.seed = seed, .stations = 1, .rays = 15'000});
}

Site::Site()
    : db(folder / "site.db"), room(make_scene({.seed = 1})), elsewhere(make_scene({.seed = 2})) {
  const Outcome indexed = index_scene(folder, db, "room", room);
  if (indexed.status != 0)
    throw std::runtime_error("indexing failed: " + indexed.err + indexed.out);
}

std::string Site::view(const std::string& name,
                       const SyntheticScene& scene,
                       const Eigen::Isometry3d& T_scene_sensor) const {
  const std::string path = folder / (name + ".ply");
  write_cloud(path, view_of(scene, T_scene_sensor, {}));
  return path;
}

const Site& site() {
  static const Site only;
  return only;
}

Eigen::Matrix4d matrix(const nlohmann::json& numbers) {
  const auto values = numbers.get<std::vector<double>>();
  if (values.size() != 16) throw std::runtime_error("want 16 numbers: " + numbers.dump());
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
}

}  // namespace landmarkdb::testing
