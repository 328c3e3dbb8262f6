#include "engine/cloud/join_clouds.hpp"

#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/cloud/merge_clouds.hpp"
#include "engine/cloud/sanitise.hpp"

namespace landmarkdb {

namespace {

PointCloud clean(PointCloud cloud, CloudCounts& counts, const RunContext& context) {
  add_counts(counts, sanitise(cloud, context));
  if (cloud.viewpoints.empty()) {
    cloud.viewpoints.emplace_back(-cloud.origin.cast<float>());
    cloud.viewpoint_index.clear();
  }
  return cloud;
}

}  // namespace

PointCloud join_clouds(std::vector<QueryCloud> clouds,
                       CloudCounts& counts,
                       const RunContext& context) {
  if (clouds.empty() || clouds.size() > kMostQueryClouds) {
    throw Error(ErrorCode::kInvalidArgument,
                "the question has " + std::to_string(clouds.size()) + " clouds, want 1 to " +
                    std::to_string(kMostQueryClouds),
                "clouds");
  }
  counts = {};
  const bool as_it_is = clouds.size() == 1 && clouds[0].T_query_cloud.matrix().isIdentity(0.0);
  if (as_it_is) return clean(std::move(clouds[0].cloud), counts, context);
  std::vector<PointCloud> cleaned;
  std::vector<Eigen::Isometry3d> poses;
  for (QueryCloud& one : clouds) {
    cleaned.push_back(clean(std::move(one.cloud), counts, context));
    poses.push_back(one.T_query_cloud);
  }
  PointCloud joined = merge_clouds(cleaned, poses, context);
  context.check("preprocess");
  // Clouds that overlap to the bit are one surface, not two votes for it.
  const CloudCounts again = sanitise(joined, context);
  counts.duplicates += again.duplicates;
  counts.out_of_range += again.out_of_range;
  counts.used = again.used;
  return joined;
}

}  // namespace landmarkdb
