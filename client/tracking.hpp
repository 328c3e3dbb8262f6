#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "client/recognition.hpp"
#include "engine/geometry/camera.hpp"

namespace landmarkdb::client {

// What a track is told once.
struct TrackSetup {
  Camera camera;
  std::string model;
  std::string servo{};                       // the text of an arm file; empty: poses only
  std::optional<Eigen::Isometry3d> start{};  // T_camera_object in the frame before the first
  // Of the recognition at the start and after a loss; `models` and `top` do not count.
  RecognizeOptions recognize{};
};

// The next frame: an image file's bytes (PNG, JPEG, PGM), or points where `image` is empty.
struct TrackInput {
  std::string image{};
  std::vector<ImagePoint> points{};
  std::vector<std::array<std::uint32_t, 2>> links{};
  std::optional<double> time_s{};        // must grow from frame to frame
  std::vector<double> q_rad{};           // the arm's joints now; empty: not measured
  std::vector<double> q_at_image_rad{};  // and when the image was taken
};

// What the arm should do now.
struct ServoAnswer {
  std::string status;                       // "running", "holding" or "stopped"
  std::vector<double> twist{};              // v (m/s) and omega (rad/s), camera frame
  std::vector<double> joint_rates_rad_s{};  // one a joint
  std::vector<double> error{};              // the task function; empty where not running
  double translation_m = 0.0;               // its size
  double rotation_rad = 0.0;
  std::uint32_t rank = 0;
  double smallest_singular = 0.0;
  bool damped = false;
  double rate_scale = 1.0;
  std::vector<std::uint32_t> at_limit{};  // joints, counted from 1
  std::vector<double> q_rad{};            // the joints it was worked out for
};

struct TrackedFrame {
  std::uint64_t frame = 0;  // of this track, from 1
  std::string status;       // "tracked", "recognized", "predicted" or "lost"
  std::string reason{};     // for the last two
  std::optional<Eigen::Isometry3d> T_camera_object{};
  std::vector<double> covariance{};  // 36; where measured
  double rms_px = 0.0;
  std::uint32_t matched = 0;
  std::uint32_t visible_points = 0;
  double edge_share = 0.0;
  double confidence = 0.0;
  std::optional<double> time_s{};
  std::optional<ServoAnswer> servo{};
  double load_ms = 0.0, track_ms = 0.0, servo_ms = 0.0, total_ms = 0.0;

  bool seen() const { return status == "tracked" || status == "recognized"; }
};

}  // namespace landmarkdb::client
