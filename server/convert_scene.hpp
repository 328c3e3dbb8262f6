#pragma once

#include <string>
#include <vector>

#include "engine/retrieval/describe_scene.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/convert_cloud.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// A request to add a scene, checked. The scans' clouds are decoded within `allowance`; the request
// may be let go of afterwards. Throws Error{kInvalidArgument}, Error{kResourceExhausted}.
struct SceneAddition {
  std::string name;
  std::vector<Scan> scans;
  IndexOptions options;
};
SceneAddition from_proto(const v1::SceneAddRequest& request, PointAllowance& allowance);

Landmark from_proto(const v1::Landmark& landmark);

// `with_versions` for `show`. `quarantined`: why the server leaves it out; empty where it does not.
v1::SceneInfo to_proto(const SceneSummary& scene,
                       bool with_versions,
                       const std::string& quarantined);

}  // namespace landmarkdb
