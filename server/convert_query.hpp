#pragma once

#include <span>

#include <Eigen/Geometry>

#include "engine/types/query.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb {

// Each throws Error{kInvalidArgument} that names the field, what was seen and what was wanted.
QueryOptions from_proto(const v1::QueryOptions& options);
// `unset` stands for KEYPOINT_METHOD_UNSPECIFIED.
KeypointMethod from_proto(v1::KeypointMethod method,
                          KeypointMethod unset,
                          const std::string& field);
// A rigid motion of 16 numbers, row-major.
Eigen::Isometry3d pose_from_proto(std::span<const double> numbers, const std::string& field);

v1::KeypointMethod to_proto(KeypointMethod method);
v1::QueryResult to_proto(const QueryResult& result);

}  // namespace landmarkdb
