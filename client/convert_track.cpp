#include "client/convert_track.hpp"

#include "client/convert_recognition.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::kInternal, "the server's answer is not as it should be: " + what);
}

std::string name_of(v1::TrackStatus status) {
  switch (status) {
    case v1::TRACK_STATUS_TRACKED:
      return "tracked";
    case v1::TRACK_STATUS_RECOGNIZED:
      return "recognized";
    case v1::TRACK_STATUS_PREDICTED:
      return "predicted";
    case v1::TRACK_STATUS_LOST:
      return "lost";
    default:
      refuse("status " + std::to_string(status));
  }
}

std::string name_of(v1::ServoStatus status) {
  switch (status) {
    case v1::SERVO_STATUS_RUNNING:
      return "running";
    case v1::SERVO_STATUS_HOLDING:
      return "holding";
    case v1::SERVO_STATUS_STOPPED:
      return "stopped";
    default:
      refuse("servo status " + std::to_string(status));
  }
}

template <typename Value>
std::vector<Value> list(const google::protobuf::RepeatedField<Value>& values) {
  return {values.begin(), values.end()};
}

ServoAnswer from_proto(const v1::ServoCommand& message) {
  ServoAnswer servo;
  servo.status = name_of(message.status());
  servo.twist = list(message.twist());
  servo.joint_rates_rad_s = list(message.joint_rates_rad_s());
  servo.error = list(message.error());
  servo.translation_m = message.translation_m();
  servo.rotation_rad = message.rotation_rad();
  servo.rank = message.rank();
  servo.smallest_singular = message.smallest_singular();
  servo.damped = message.damped();
  servo.rate_scale = message.rate_scale();
  servo.at_limit = list(message.at_limit());
  servo.q_rad = list(message.q_rad());
  if (servo.twist.size() != 6) refuse("a twist of " + std::to_string(servo.twist.size()));
  return servo;
}

}  // namespace

v1::TrackOpenRequest to_proto(const TrackSetup& setup) {
  v1::TrackOpenRequest message;
  *message.mutable_camera() = to_proto(setup.camera);
  message.set_model(setup.model);
  message.set_servo(setup.servo);
  if (setup.start) {
    for (const double number : to_row_major(setup.start->matrix())) {
      message.add_start_t_camera_object(number);
    }
  }
  v1::TrackOptions& options = *message.mutable_options();
  options.set_min_confidence(setup.recognize.min_confidence);
  options.set_min_depth_m(setup.recognize.min_depth_m);
  options.set_max_depth_m(setup.recognize.max_depth_m);
  options.set_seed(setup.recognize.seed);
  return message;
}

v1::TrackFrameRequest to_proto(const TrackInput& input, std::uint32_t track) {
  v1::TrackFrameRequest message;
  message.set_track(track);
  if (!input.image.empty()) {
    message.set_image(input.image);
  } else {
    *message.mutable_points() = to_proto(input.points, input.links);
  }
  if (input.time_s) message.set_time_s(*input.time_s);
  for (const double angle : input.q_rad) message.add_q_rad(angle);
  for (const double angle : input.q_at_image_rad) message.add_q_at_image_rad(angle);
  return message;
}

TrackedFrame from_proto(const v1::TrackFrameResult& message) {
  TrackedFrame frame;
  frame.frame = message.frame();
  frame.status = name_of(message.status());
  frame.reason = message.reason();
  const int numbers = message.t_camera_object_size();
  if (numbers != (frame.status == "lost" ? 0 : 16)) {
    refuse(frame.status + " with a pose of " + std::to_string(numbers) + " numbers");
  }
  if (numbers > 0) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int i = 0; i < numbers; ++i) T.matrix()(i / 4, i % 4) = message.t_camera_object(i);
    frame.T_camera_object = T;
  }
  frame.covariance = list(message.covariance());
  frame.rms_px = message.rms_px();
  frame.matched = message.matched();
  frame.visible_points = message.visible_points();
  frame.edge_share = message.edge_share();
  frame.confidence = message.confidence();
  if (message.has_time_s()) frame.time_s = message.time_s();
  if (message.has_servo()) frame.servo = from_proto(message.servo());
  frame.load_ms = message.timing().load_ms();
  frame.track_ms = message.timing().track_ms();
  frame.servo_ms = message.timing().servo_ms();
  frame.total_ms = message.timing().total_ms();
  return frame;
}

}  // namespace landmarkdb::client
