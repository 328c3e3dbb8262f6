#pragma once

#include "client/answers.hpp"
#include "engine/base/error.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::client {

// Our structs to the wire's messages and back, in the client's direction: requests out, answers in.
// Transforms are row-major on the wire, column-major in Eigen; this is where that ends.

struct CloudEncoding {
  bool zstd = false;  // compress the points; only where the server says it can
};

// Points as float32, bit for bit; the first viewpoint, where there is one; normals and colours stay
// behind.
v1::Cloud to_proto(const PointCloud& cloud, const CloudEncoding& encoding);
// Adds one of a question's clouds, and its pose.
void add_to_proto(const QueryCloud& cloud, const CloudEncoding& encoding, v1::QueryRequest& out);
v1::QueryOptions to_proto(const QueryOptions& options);
v1::SceneAddRequest to_proto(const SceneAdd& add, const CloudEncoding& encoding);
v1::Landmark to_proto(const Landmark& landmark);

// Throw Error{kInternal} where the server's answer is not what the protocol promises (an array of
// another length, a status without a number).
QueryResult from_proto(const v1::QueryResult& result);
Explanation from_proto(const v1::Explanation& explanation);
SceneView from_proto(const v1::SceneView& view);
SceneInfo from_proto(const v1::SceneInfo& scene);
Stats from_proto(const v1::StatsReply& stats);
Health from_proto(const v1::HealthReply& health);

// The Error a server replied with, to be thrown.
Error from_proto(const v1::Error& error);

}  // namespace landmarkdb::client
