#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/types/query.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/convert_cloud.hpp"

namespace landmarkdb {

// Each throws Error{kInvalidArgument} that names the field, what was seen and what was wanted.
QueryOptions from_proto(const v1::QueryOptions& options);
// `unset` stands for KEYPOINT_METHOD_UNSPECIFIED.
KeypointMethod from_proto(v1::KeypointMethod method,
                          KeypointMethod unset,
                          const std::string& field);
// A rigid motion of 16 numbers, row-major.
Eigen::Isometry3d pose_from_proto(std::span<const double> numbers, const std::string& field);

// The clouds with their poses; the points are taken from `allowance` (server/convert_cloud.hpp,
// which says what is thrown beside).
std::vector<QueryCloud> clouds_from_proto(const v1::QueryRequest& request,
                                          PointAllowance& allowance);

v1::KeypointMethod to_proto(KeypointMethod method);
v1::QueryResult to_proto(const QueryResult& result);

}  // namespace landmarkdb
