#include "client/render_track.hpp"

#include <nlohmann/json.hpp>

#include "client/pose_values.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

Json servo_json(const ServoAnswer& servo) {
  return {{"status", servo.status},
          {"twist", servo.twist},
          {"joint_rates", servo.joint_rates_rad_s},
          {"error", servo.error},
          {"translation_m", servo.translation_m},
          {"rotation_rad", servo.rotation_rad},
          {"rank", servo.rank},
          {"smallest_singular", servo.smallest_singular},
          {"damped", servo.damped},
          {"rate_scale", servo.rate_scale},
          {"at_limit", servo.at_limit},
          {"q", servo.q_rad}};
}

}  // namespace

Json track_json(const std::string& name, const TrackedFrame& frame) {
  Json out;
  out["frame"] = name;
  out["status"] = frame.status;
  if (!frame.reason.empty()) out["reason"] = frame.reason;
  if (frame.T_camera_object) {
    const Eigen::Isometry3d& T = *frame.T_camera_object;
    out["T_camera_object"] = to_row_major(T.matrix());
    out["translation_m"] = vector_json(T.translation());
    out["euler_zyx_deg"] = vector_json(euler_zyx_deg(T.linear()));
  } else {
    for (const char* key : {"T_camera_object", "translation_m", "euler_zyx_deg"}) {
      out[key] = nullptr;
    }
  }
  out["rms_px"] = frame.rms_px;
  out["matched"] = frame.matched;
  out["visible_points"] = frame.visible_points;
  out["edge_share"] = frame.edge_share;
  out["confidence"] = frame.confidence;
  if (!frame.covariance.empty()) out["covariance"] = frame.covariance;
  if (frame.time_s) out["time_s"] = *frame.time_s;
  if (frame.servo) out["servo"] = servo_json(*frame.servo);
  out["timing_ms"] = {{"load", frame.load_ms},
                      {"track", frame.track_ms},
                      {"servo", frame.servo_ms},
                      {"total", frame.total_ms}};
  return out;
}

Json unusable_frame_json(const std::string& name, const std::string& reason) {
  return {{"frame", name}, {"status", "error"}, {"reason", reason}};
}

}  // namespace landmarkdb::client
