#include "engine/cloud/merge_clouds.hpp"

#include <string>

#include "engine/base/error.hpp"
#include "engine/cloud/cloud_merger.hpp"

namespace landmarkdb {

PointCloud merge_clouds(std::span<const PointCloud> clouds,
                        std::span<const Eigen::Isometry3d> T_scene_cloud,
                        const RunContext& context) {
  if (clouds.size() != T_scene_cloud.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(clouds.size()) + " clouds come with " +
                    std::to_string(T_scene_cloud.size()) + " poses, want one each");
  }
  std::size_t points = 0;
  for (const PointCloud& cloud : clouds) points += cloud.size();
  CloudMerger merger;
  merger.reserve(points);
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    merger.begin_scan(T_scene_cloud[c]);
    merger.append(clouds[c], context);
  }
  return merger.finish();
}

}  // namespace landmarkdb
