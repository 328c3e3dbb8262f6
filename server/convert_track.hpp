#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "engine/mono/tracker.hpp"
#include "engine/servo/servo.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb {

// Each throws Error{kInvalidArgument} that names the field, what was seen and what was wanted.
TrackOptions from_proto(const v1::TrackOptions& options);
// 16 numbers, or none.
std::optional<Eigen::Isometry3d> pose_from(const google::protobuf::RepeatedField<double>& numbers,
                                           const std::string& field);
// One finite angle a joint of `arm`, or none.
std::optional<JointVector> joints_from(const google::protobuf::RepeatedField<double>& numbers,
                                       const Arm& arm,
                                       const std::string& field);

// All but the frame's number, time and servo command.
v1::TrackFrameResult to_proto(const TrackResult& result);
v1::ServoCommand to_proto(const ServoCommand& command, const JointVector& q);

}  // namespace landmarkdb
