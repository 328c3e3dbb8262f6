#pragma once

#include "engine/types/explanation.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb {

v1::Explanation to_proto(const Explanation& explanation);

}  // namespace landmarkdb
