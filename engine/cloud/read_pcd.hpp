#pragma once

#include "engine/cloud/input.hpp"
#include "engine/cloud/read_cloud.hpp"

namespace landmarkdb {

// A PCD file: ascii, binary or binary_compressed, organised or not. Throws Error{kInvalidArgument}.
void parse_pcd(const Input& input, const ReadOptions& options, const CloudSink& sink);

}  // namespace landmarkdb
