#include "indexer/add_scene.hpp"

#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/retrieval/scene_index.hpp"
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

// Zero for what is not there: reading it will say so.
std::uint64_t bytes_of(const std::string& path) {
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
  return failed ? 0 : bytes;
}

// The same context, where the bytes of one file are counted after those `before` it.
RunContext one_of_many(const RunContext& context, std::uint64_t before, std::uint64_t total) {
  RunContext one = context;
  if (!context.progress) return one;
  one.progress = [&context, before, total](const Progress& progress) {
    context.progress(progress.stage == "read"
                         ? Progress{progress.stage, before + progress.done, total}
                         : progress);
  };
  return one;
}

}  // namespace

GatheredScans gather_scans(const AddRequest& request, const RunContext& context) {
  const ReadOptions read_options{.units = request.units};
  std::uint64_t total = 0;
  for (const std::string& cloud : request.clouds) total += bytes_of(cloud);
  std::uint64_t before = 0;
  ScanGatherer gatherer(request.options, context);
  for (std::size_t i = 0; i < request.clouds.size(); ++i) {
    const std::string& path = request.clouds[i];
    gatherer.begin_scan(std::filesystem::path(path).filename().string(),
                        request.poses.empty() ? Eigen::Isometry3d::Identity() : request.poses[i]);
    const CloudSink sink{gatherer.block_points(), [&](PointCloud block) {
                           if (!request.viewpoints.empty()) {
                             set_viewpoint(request.viewpoints[i], block);
                           }
                           gatherer.add(std::move(block));
                         }};
    read_cloud_in_blocks(path, read_options, one_of_many(context, before, total), sink);
    before += bytes_of(path);
  }
  return gatherer.finish();
}

AddResult add_scene(const AddRequest& request, const std::string& db, const RunContext& context) {
  validate_name(request.name, "scene name");
  require_writable_database(db);
  AddResult result;
  result.record =
      describe_scene(request.name, gather_scans(request, context), request.options, context);
  result.stored = change_or_create(db, [&](Store& store) {
    return store.insert(result.record, context, {make_scene_index, scene_index_format()});
  });
  return result;
}

}  // namespace landmarkdb::indexer
