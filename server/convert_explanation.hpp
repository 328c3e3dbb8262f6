#pragma once

#include "engine/types/explanation.hpp"
#include "engine/types/scene_view.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb {

v1::Explanation to_proto(const Explanation& explanation);

// Points as 16-bit numbers; the origin apart, so that a georeferenced view keeps its millimetres.
v1::SceneView to_proto(const SceneView& view);

}  // namespace landmarkdb
