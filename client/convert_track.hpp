#pragma once

#include "client/tracking.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::client {

v1::TrackOpenRequest to_proto(const TrackSetup& setup);
v1::TrackFrameRequest to_proto(const TrackInput& input, std::uint32_t track);

// Throws Error{kInternal} where the server's answer is not what the protocol promises.
TrackedFrame from_proto(const v1::TrackFrameResult& result);

}  // namespace landmarkdb::client
