#pragma once

#include "client/recognition.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::client {

v1::Camera to_proto(const Camera& camera);
v1::ImagePoints to_proto(const std::vector<ImagePoint>& points,
                         const std::vector<std::array<std::uint32_t, 2>>& links);
v1::RecognizeRequest to_proto(const RecognizeInput& input, const RecognizeOptions& options);
v1::ModelAddRequest to_proto(const ModelAdd& add);

// Throw Error{kInternal} where the server's answer is not what the protocol promises.
RecognizeAnswer from_proto(const v1::RecognizeResult& result);
ModelSummary from_proto(const v1::ModelInfo& model);

}  // namespace landmarkdb::client
