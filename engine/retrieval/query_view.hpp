#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/base/stage_timings.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/range_image.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// The query cloud, cleaned once; what is common to every working resolution.
struct CleanQuery {
  PointCloud cloud;  // sanitised, with a viewpoint
  CloudCounts counts;
  double spacing_m = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the points: where two poses are compared
  RangeImage ranges;                                 // free space as the sensor saw it
};

// Cleans a query. Its viewpoint is the sensor frame's zero unless the cloud has one.
// Throws what `context.check` does.
CleanQuery clean_query(PointCloud cloud, const RunContext& context = {});

// The query as an entry of one resolution sees it.
struct QueryView {
  PreparedCloud prepared;
  DescriptorSet descriptors;
  TestPoints test;                             // for testing proposals, most telling first
  std::vector<Eigen::Vector3f> sample_points;  // spread evenly, for refinement and overlap
  std::vector<Eigen::Vector3f> sample_normals;
};

QueryView view_query(const CleanQuery& query,
                     const FeatureOptions& options,
                     std::uint64_t seed,
                     const RunContext& context,
                     StageTimings& timings);

}  // namespace landmarkdb
