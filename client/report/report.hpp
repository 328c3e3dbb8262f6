#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::client {

// What a report is made from beside the answer.
struct ReportInput {
  std::string cloud_name;  // as it was typed
  PointCloud cloud;        // as it was sent
  QueryOptions options;    // as they were asked
};

// One page that shows the answer: the place from above and from the side with the cloud laid into
// it, pairs, frustum and frames; verdict, candidates, chain, funnel and times as tables. Nothing in
// it refers to anything outside, and every name is escaped. The same input gives the same bytes.
//
// Draws what the result holds: scene views, pairs and the explanation are there when the query
// asked for them (QueryOptions::want_scene_points and so on).
std::string report_html(const ReportInput& input, const QueryResult& result);

}  // namespace landmarkdb::client
