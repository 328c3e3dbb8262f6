#pragma once

#include <string>

#include "engine/geometry/camera.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/types/recognition.hpp"
#include "proto/landmarkdb.pb.h"
#include "store/model_types.hpp"

namespace landmarkdb {

// More are refused before they are copied: the recogniser itself looks at far fewer.
inline constexpr int kMaxImagePoints = 100'000;

// Each throws Error{kInvalidArgument} that names the field, what was seen and what was wanted.
Camera from_proto(const v1::Camera& camera);
RecognizeOptions from_proto(const v1::RecognizeOptions& options);
// The points as features of an image of the camera's size.
ImageFeatures from_proto(const v1::ImagePoints& points, const Camera& camera);

v1::RecognizeResult to_proto(const RecognizeResult& result);
// `quarantined`: why the server leaves it out; empty where it does not.
v1::ModelInfo to_proto(const ModelSummary& model, const std::string& quarantined);

}  // namespace landmarkdb
