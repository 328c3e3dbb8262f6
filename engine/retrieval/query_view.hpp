#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/base/stage_timings.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/features/range_noise.hpp"
#include "engine/registration/plane_layout.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/range_image.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// The query cloud, cleaned once; what is common to every working resolution.
struct CleanQuery {
  PointCloud cloud;  // sanitised, with a viewpoint
  CloudCounts counts;
  CloudScale scale;                                  // zeros for fewer than four points
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the points: where two poses are compared
  std::vector<RangeImage> ranges;  // free space as the sensor saw it, one for each viewpoint
};

// What was seen from each viewpoint, in cells of this width at the least; viewpoints that nothing
// was seen from are left out.
std::vector<RangeImage> range_images(const PointCloud& cloud, double finest_step_rad);

// Cleans a query and lays its clouds together (join_clouds, which says what is thrown).
CleanQuery clean_query(std::vector<QueryCloud> clouds, const RunContext& context = {});
CleanQuery clean_query(const PointCloud& cloud, const RunContext& context = {});  // one alone

// The part of the query whose points are no further apart than `spacing_m`, without range images;
// empty where there is none.
CleanQuery dense_part(const CleanQuery& query, double spacing_m, const RunContext& context);

// The query as an entry of one resolution sees it.
struct QueryView {
  PreparedCloud prepared;
  DescriptorSet descriptors;
  TestPoints test;                             // for testing proposals, most telling first
  std::vector<Eigen::Vector3f> sample_points;  // spread evenly, for refinement and overlap
  std::vector<Eigen::Vector3f> sample_normals;
  // Of places: points as they were measured, the fewer the noisier they are. Laying noise flat
  // rounds corners off; the last refinement goes by these.
  std::vector<Eigen::Vector3f> precise_points;
  std::vector<Eigen::Vector3f> precise_normals;
  RangeNoise noise;                 // of a view for objects, about bent surface
  std::vector<PlaneLayout> planes;  // what may be the frames of right angles it shows
};

// The same for objects that stand in the query: without what places alone are asked for (`test`,
// `planes`).
QueryView view_for_objects(const CleanQuery& query,
                           const FeatureOptions& options,
                           const RunContext& context,
                           StageTimings& timings);

QueryView view_query(const CleanQuery& query,
                     const FeatureOptions& options,
                     std::uint64_t seed,
                     const RunContext& context,
                     StageTimings& timings);

}  // namespace landmarkdb
