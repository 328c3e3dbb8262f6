#include "indexer/add_scene.hpp"

#include <filesystem>
#include <utility>

#include "indexer/new_database.hpp"
#include "store/names.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

// One viewpoint for the whole cloud, instead of what the file said. The cloud's points are floats
// around its origin, and so are its viewpoints.
void set_viewpoint(const Eigen::Vector3d& viewpoint_m, PointCloud& cloud) {
  cloud.viewpoints = {(viewpoint_m - cloud.origin).cast<float>()};
  cloud.viewpoint_index.clear();
}

}  // namespace

std::vector<Scan> read_scans(const AddRequest& request, const RunContext& context) {
  const ReadOptions read_options{.units = request.units};
  std::vector<Scan> scans;
  scans.reserve(request.clouds.size());
  for (std::size_t i = 0; i < request.clouds.size(); ++i) {
    context.report("read", i, request.clouds.size());
    Scan scan;
    scan.cloud = read_cloud(request.clouds[i], read_options);
    if (!request.poses.empty()) scan.T_scene_cloud = request.poses[i];
    if (!request.viewpoints.empty()) set_viewpoint(request.viewpoints[i], scan.cloud);
    scan.source = std::filesystem::path(request.clouds[i]).filename().string();
    scans.push_back(std::move(scan));
  }
  context.report("read", request.clouds.size(), request.clouds.size());
  return scans;
}

AddResult add_scene(const AddRequest& request, const std::string& db, const RunContext& context) {
  validate_name(request.name, "scene name");
  require_writable_database(db);
  AddResult result;
  result.record =
      describe_scene(request.name, read_scans(request, context), request.options, context);
  result.stored =
      change_or_create(db, [&](Store& store) { return store.insert(result.record, context); });
  return result;
}

}  // namespace landmarkdb::indexer
