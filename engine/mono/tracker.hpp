#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/geometry/camera.hpp"
#include "engine/mono/align_model.hpp"
#include "engine/mono/image_features.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/mono/track_samples.hpp"
#include "engine/mono/visibility.hpp"
#include "engine/types/grey_image.hpp"
#include "engine/types/mono_model.hpp"
#include "engine/types/recognition.hpp"

namespace landmarkdb {

struct TrackOptions {
  double reach_px = 20.0;         // how far along an edge's normal its image is looked for
  double point_reach_px = 8.0;    // and a feature point around its predicted place
  std::size_t patience = 3;       // frames without the object before it is recognised anew
  double min_edge_share = 0.4;    // of the visible edges' length, to believe a frame
  double min_point_share = 0.35;  // of the visible points, likewise
  RecognizeOptions recognize{};   // for the first frame and after a loss; `models` is set by us
};

enum class TrackStatus {
  kTracked,     // followed from the frame before
  kRecognized,  // found anew
  kPredicted,   // not seen in this frame; the pose is where it should be by now
  kLost         // not seen for longer, and not recognised either: there is no pose
};
std::string_view to_string(TrackStatus status);

struct TrackResult {
  TrackStatus status = TrackStatus::kLost;
  std::string reason{};  // for kPredicted and kLost: what was missing
  std::optional<Eigen::Isometry3d> T_camera_object{};
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  // of (x, y, z, rx, ry, rz), camera frame, m and rad
  double rms_px = 0.0;
  std::size_t matched = 0;  // visible points of the model that were found, or whose edges were
  std::size_t visible_points = 0;
  double edge_share = 0.0;  // of the visible edges' length, what lies on edges of the image
  // Of the recognition that the track goes back to; 1 where its start was given, 0 without a pose.
  double confidence = 0.0;
  bool measured() const {
    return status == TrackStatus::kTracked || status == TrackStatus::kRecognized;
  }
};

// Follows one model from image to image.
//
// The pose is predicted (constant velocity in the camera frame), its visible edges are searched
// for along their normals and its points around their places, the pose is refined on what was
// found, and checked. Without a pose, and after `patience` frames without the object, it is
// recognised anew. One call a frame, frames at even intervals. Not thread-safe; the same frames
// give the same poses.
class Tracker {
 public:
  // `recognizer` may be null: then tracking needs a start. It must outlive the tracker and know a
  // model of that name. Throws Error{kInvalidArgument} for options out of range.
  Tracker(std::shared_ptr<const MonoModelRecord> record,
          const Camera& camera,
          const TrackOptions& options,
          const Recognizer* recognizer);

  // Where the object is in the frame before the next one. Throws Error{kInvalidArgument} for what
  // is not finite or has the object behind the camera.
  void start_from(const Eigen::Isometry3d& T_camera_object);

  // Throws Error{kInvalidArgument} for an image whose size is not the camera's, or a coordinate
  // that is not finite; what `run.check` throws.
  TrackResult next(const GreyImage& image, const RunContext& run);
  // From features: its points, and its edge points where there are any.
  TrackResult next(const ImageFeatures& features, const RunContext& run);

 private:
  struct Frame;
  struct Fit;

  TrackResult advance(const Frame& frame, const RunContext& run);
  std::optional<Fit> follow(const Frame& frame, const RigidPose& predicted) const;
  std::optional<Fit> settle(const Frame& frame, const RigidPose& from, double reach_px) const;
  std::optional<Fit> align(const Frame& frame, const RigidPose& from, double reach_px) const;
  std::vector<PosePoint> match_points(const Frame& frame,
                                      const RigidPose& pose,
                                      double reach_px) const;
  void judge(const Frame& frame, Fit& fit) const;
  TrackResult found(const Frame& frame, const Fit& fit, TrackStatus status);
  TrackResult missed(const Frame& frame, const RigidPose& predicted, const RunContext& run);
  TrackResult recognised(const Frame& frame, const RunContext& run);
  RigidPose predict() const;

  std::shared_ptr<const MonoModelRecord> record_;
  Camera camera_;
  TrackOptions options_;
  const Recognizer* recognizer_;
  ModelVisibility visibility_;
  std::vector<PosePoint> points_;  // the model's, as they are measured
  std::optional<RigidPose> pose_;  // of the last frame, predicted where it was not seen
  RigidPose motion_;               // from frame to frame, in the camera frame
  std::size_t missed_ = 0;
  EdgeMemory memory_;        // what the edges looked like when last seen
  double last_share_ = 0.0;  // of what should be seen, found in the last frame
  double confidence_ = 0.0;  // of the start of this track
};

}  // namespace landmarkdb
