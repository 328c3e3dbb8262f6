#include "tests/unit/engine/retrieval/rooms.hpp"

#include <utility>

namespace landmarkdb::testing {

SyntheticScene small_room(std::uint64_t seed) {
  SceneOptions options;
  options.seed = seed;
  options.rays = 20'000;
  options.stations = 3;
  return make_scene(options);
}

Frame frame_in(const SyntheticScene& scene, std::uint64_t seed) {
  Frame frame;
  frame.T_scene_sensor = make_view_pose(scene, seed);
  ViewOptions view;
  view.seed = seed;
  frame.cloud = view_of(scene, frame.T_scene_sensor, view);
  frame.up_sensor = frame.T_scene_sensor.linear().transpose() * Eigen::Vector3d::UnitZ();
  return frame;
}

SceneRecord describe(const std::string& name, PointCloud cloud, const IndexOptions& options) {
  std::vector<Scan> scans(1);
  scans[0].cloud = std::move(cloud);
  scans[0].source = name + ".ply";
  return describe_scene(name, std::move(scans), options, RunContext{});
}

SceneRecord describe_room(const std::string& name, const SyntheticScene& scene) {
  IndexOptions options;
  options.up = Eigen::Vector3d::UnitZ();
  return describe(name, scene.cloud, options);
}

std::unique_ptr<Localizer> localizer_of(std::vector<SceneRecord> records) {
  auto catalog = std::make_shared<Catalog>();
  for (SceneRecord& record : records) {
    CatalogEntry entry;
    entry.scene_id = static_cast<std::int64_t>(catalog->entries.size()) + 1;
    entry.version = 1;
    entry.record = std::make_shared<const SceneRecord>(std::move(record));
    catalog->entries.push_back(std::move(entry));
  }
  return std::make_unique<Localizer>(catalog, RunContext{});
}

PointCloud moved(PointCloud cloud, const Eigen::Isometry3d& T) {
  const Eigen::Isometry3f T_float = T.cast<float>();
  for (Eigen::Vector3f& p : cloud.points) p = T_float * p;
  for (Eigen::Vector3f& n : cloud.normals) n = T_float.linear() * n;
  for (Eigen::Vector3f& v : cloud.viewpoints) v = T_float * v;
  return cloud;
}

}  // namespace landmarkdb::testing
