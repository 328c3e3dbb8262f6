#include "server/convert_track.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "server/convert_recognition.hpp"

namespace landmarkdb {
namespace {

constexpr std::uint32_t kMostPatience = 1000;  // frames

double reach(double value, const std::string& field) {
  constexpr double kLeast_px = 1.0;
  constexpr double kMost_px = 200.0;
  if (value >= kLeast_px && value <= kMost_px) return value;  // also refuses NaN
  throw Error(ErrorCode::kInvalidArgument,
              field + ": is " + std::to_string(value) + " px, want 1 to 200",
              field);
}

v1::TrackStatus status_of(TrackStatus status) {
  switch (status) {
    case TrackStatus::kTracked:
      return v1::TRACK_STATUS_TRACKED;
    case TrackStatus::kRecognized:
      return v1::TRACK_STATUS_RECOGNIZED;
    case TrackStatus::kPredicted:
      return v1::TRACK_STATUS_PREDICTED;
    case TrackStatus::kLost:
      return v1::TRACK_STATUS_LOST;
  }
  return v1::TRACK_STATUS_UNSPECIFIED;
}

v1::ServoStatus status_of(ServoStatus status) {
  switch (status) {
    case ServoStatus::kRunning:
      return v1::SERVO_STATUS_RUNNING;
    case ServoStatus::kHolding:
      return v1::SERVO_STATUS_HOLDING;
    case ServoStatus::kStopped:
      return v1::SERVO_STATUS_STOPPED;
  }
  return v1::SERVO_STATUS_UNSPECIFIED;
}

}  // namespace

TrackOptions from_proto(const v1::TrackOptions& message) {
  TrackOptions options;
  if (message.has_reach_px()) options.reach_px = reach(message.reach_px(), "options.reach_px");
  if (message.has_point_reach_px()) {
    options.point_reach_px = reach(message.point_reach_px(), "options.point_reach_px");
  }
  if (message.has_patience()) {
    if (message.patience() > kMostPatience) {
      throw Error(ErrorCode::kInvalidArgument,
                  "options.patience: is " + std::to_string(message.patience()) +
                      " frames, want at most " + std::to_string(kMostPatience),
                  "options.patience");
    }
    options.patience = message.patience();
  }
  v1::RecognizeOptions recognize;
  if (message.has_min_confidence()) recognize.set_min_confidence(message.min_confidence());
  if (message.has_min_depth_m()) recognize.set_min_depth_m(message.min_depth_m());
  if (message.has_max_depth_m()) recognize.set_max_depth_m(message.max_depth_m());
  if (message.has_seed()) recognize.set_seed(message.seed());
  options.recognize = from_proto(recognize);
  return options;
}

std::optional<Eigen::Isometry3d> pose_from(const google::protobuf::RepeatedField<double>& numbers,
                                           const std::string& field) {
  if (numbers.empty()) return std::nullopt;
  constexpr std::size_t kNumbers = 16;
  if (numbers.size() != static_cast<int>(kNumbers)) {
    throw Error(ErrorCode::kInvalidArgument,
                field + ": " + std::to_string(numbers.size()) + " numbers, want none or 16",
                field);
  }
  try {
    return from_row_major(std::span<const double, kNumbers>(numbers.data(), kNumbers));
  } catch (const Error& error) {
    throw Error(ErrorCode::kInvalidArgument, field + ": " + error.what(), field);
  }
}

std::optional<JointVector> joints_from(const google::protobuf::RepeatedField<double>& numbers,
                                       const Arm& arm,
                                       const std::string& field) {
  if (numbers.empty()) return std::nullopt;
  const JointVector q = Eigen::Map<const JointVector>(numbers.data(), numbers.size());
  try {
    check_joint_angles(arm, q);
  } catch (const Error& error) {
    throw Error(error.code(), field + ": " + error.what(), field);
  }
  return q;
}

v1::TrackFrameResult to_proto(const TrackResult& result) {
  v1::TrackFrameResult message;
  message.set_status(status_of(result.status));
  message.set_reason(result.reason);
  if (result.T_camera_object) {
    for (const double number : to_row_major(result.T_camera_object->matrix())) {
      message.add_t_camera_object(number);
    }
  }
  if (result.measured()) {
    for (Eigen::Index i = 0; i < 36; ++i) message.add_covariance(result.covariance(i / 6, i % 6));
  }
  message.set_rms_px(result.rms_px);
  message.set_matched(static_cast<std::uint32_t>(result.matched));
  message.set_visible_points(static_cast<std::uint32_t>(result.visible_points));
  message.set_edge_share(result.edge_share);
  message.set_confidence(result.confidence);
  return message;
}

v1::ServoCommand to_proto(const ServoCommand& command, const JointVector& q) {
  v1::ServoCommand message;
  message.set_status(status_of(command.status));
  for (const double number : command.twist) message.add_twist(number);
  for (const double number : command.joint_rates) message.add_joint_rates_rad_s(number);
  for (const double number : command.error) message.add_error(number);
  message.set_translation_m(command.translation_m);
  message.set_rotation_rad(command.rotation_rad);
  message.set_rank(static_cast<std::uint32_t>(command.rank));
  message.set_smallest_singular(command.smallest_singular);
  message.set_damped(command.damped);
  message.set_rate_scale(command.rate_scale);
  for (const Eigen::Index joint : command.at_limit) {
    message.add_at_limit(static_cast<std::uint32_t>(joint) + 1);
  }
  for (const double number : q) message.add_q_rad(number);
  return message;
}

}  // namespace landmarkdb
