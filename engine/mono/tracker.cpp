#include "engine/mono/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/edge_search.hpp"
#include "engine/mono/refine_pose.hpp"
#include "engine/mono/search_model.hpp"

namespace landmarkdb {
namespace {

constexpr double kOnEdge_px = 2.0;        // a sample this near lies on an edge of the image
constexpr double kOnPoint_px = 3.5;       // and a point on a feature
constexpr double kOnEdgeCosine = 0.94;    // 20 degrees
constexpr std::size_t kFewestPoints = 4;  // a pose on three points always fits

RigidPose still() { return {Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()}; }

void check_options(const TrackOptions& options) {
  const auto want = [](bool holds, const char* name, double seen, const char* wanted) {
    if (holds) return;
    std::ostringstream message;
    message << name << " is " << seen << ", want " << wanted;
    throw Error(ErrorCode::kInvalidArgument, message.str());
  };
  constexpr double kFurthest_px = 200.0;
  want(options.reach_px >= 1.0 && options.reach_px <= kFurthest_px,
       "reach_px",
       options.reach_px,
       "1 to 200");
  want(options.point_reach_px >= 1.0 && options.point_reach_px <= kFurthest_px,
       "point_reach_px",
       options.point_reach_px,
       "1 to 200");
  want(options.min_edge_share > 0.0 && options.min_edge_share <= 1.0,
       "min_edge_share",
       options.min_edge_share,
       "above 0, at most 1");
  want(options.min_point_share > 0.0 && options.min_point_share <= 1.0,
       "min_point_share",
       options.min_point_share,
       "above 0, at most 1");
}

void check_start(const Eigen::Isometry3d& T_camera_object, const MonoModel& model) {
  if (!T_camera_object.matrix().allFinite()) {
    throw Error(ErrorCode::kInvalidArgument, "the start pose has a number that is not finite");
  }
  const double depth_m = (T_camera_object * mean_point(model)).z();
  if (depth_m > 0.0) return;
  std::ostringstream text;
  text << "the start pose has the object behind the camera (z " << depth_m << " m)";
  throw Error(ErrorCode::kInvalidArgument, text.str(), "start_t_camera_object");
}

}  // namespace

// What is seen at one moment: an image, features of one, or both.
struct Tracker::Frame {
  const GreyImage* image = nullptr;
  const ImageFeatures* features = nullptr;
};

// A pose with what speaks for it.
struct Tracker::Fit {
  Alignment alignment;
  std::vector<TrackSample> samples{};
  EdgeCandidates candidates{};
  std::size_t points_matched = 0;  // of the features
  std::size_t matched = 0;
  std::size_t visible = 0;
  double edge_share = 0.0;
  bool believed = false;
  std::string reason{};

  // How much of what should be seen was found: by edges where there are any, else by points.
  double share() const {
    if (!samples.empty()) return edge_share;
    return visible == 0 ? 0.0 : static_cast<double>(matched) / static_cast<double>(visible);
  }
};

std::string_view to_string(TrackStatus status) {
  constexpr std::string_view kNames[] = {"tracked", "recognized", "predicted", "lost"};
  return kNames[static_cast<std::size_t>(status)];
}

Tracker::Tracker(std::shared_ptr<const MonoModelRecord> record,
                 const Camera& camera,
                 const TrackOptions& options,
                 const Recognizer* recognizer)
    : record_(std::move(record)),
      camera_(camera),
      options_(options),
      recognizer_(recognizer),
      visibility_(record_->model),
      points_(pose_points(record_->model)),
      motion_(still()),
      memory_(record_->model.edges.size() + record_->model.circles.size()) {
  check_options(options_);
  options_.recognize.models = {record_->model.name};
}

void Tracker::start_from(const Eigen::Isometry3d& T_camera_object) {
  check_start(T_camera_object, record_->model);
  pose_ = RigidPose{T_camera_object.linear(), T_camera_object.translation()};
  motion_ = still();
  missed_ = 0;
  last_share_ = 0.0;
  confidence_ = 1.0;
  memory_.clear();
}

TrackResult Tracker::next(const GreyImage& image, const RunContext& run) {
  if (image.width != camera_.width || image.height != camera_.height ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * image.height) {
    throw Error(ErrorCode::kInvalidArgument,
                "the image has " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " pixels, but the camera " +
                    std::to_string(camera_.width) + " x " + std::to_string(camera_.height));
  }
  return advance({.image = &image}, run);
}

TrackResult Tracker::next(const ImageFeatures& features, const RunContext& run) {
  for (std::size_t i = 0; i < features.points.size(); ++i) {
    if (features.points[i].uv.allFinite() && features.points[i].sigma_px > 0.0) continue;
    throw Error(ErrorCode::kInvalidArgument,
                "feature point " + std::to_string(i) + " is not finite, or its sigma not positive");
  }
  return advance({.features = &features}, run);
}

TrackResult Tracker::advance(const Frame& frame, const RunContext& run) {
  run.check("track");
  if (!pose_) return missed(frame, still(), run);
  const RigidPose predicted = predict();
  std::optional<Fit> fit = follow(frame, predicted);
  // A motion that has just stopped is better searched from where the object was.
  if (!fit || !fit->believed) {
    std::optional<Fit> again = follow(frame, *pose_);
    if (again && again->believed) fit = std::move(again);
  }
  if (!fit || !fit->believed) return missed(frame, predicted, run);
  return found(frame, *fit, TrackStatus::kTracked);
}

RigidPose Tracker::predict() const {
  return {nearest_rotation(motion_.R * pose_->R), motion_.R * pose_->t + motion_.t};
}

// Near, where the prediction holds; where that shows less than the frame before, wide, then near:
// the second time the edges that are visible, their directions and the nearest candidates are
// those of the right pose.
std::optional<Tracker::Fit> Tracker::follow(const Frame& frame, const RigidPose& predicted) const {
  constexpr double kNear_px = 6.0;
  constexpr double kAsGood = 0.9;  // of the share of the frame before
  std::optional<Fit> near = settle(frame, predicted, std::min(kNear_px, options_.reach_px));
  if (near && near->believed && near->share() >= kAsGood * last_share_) return near;
  std::optional<Fit> wide = align(frame, predicted, options_.reach_px);
  if (wide) wide = settle(frame, wide->alignment.pose, std::min(kNear_px, options_.reach_px));
  if (!wide) return near;
  if (!near) return wide;
  return wide->share() > near->share() ? wide : near;
}

std::optional<Tracker::Fit> Tracker::settle(const Frame& frame,
                                            const RigidPose& from,
                                            double reach_px) const {
  std::optional<Fit> fit = align(frame, from, reach_px);
  if (!fit) return std::nullopt;
  fit = align(frame, fit->alignment.pose, reach_px);
  if (fit) judge(frame, *fit);
  return fit;
}

std::optional<Tracker::Fit> Tracker::align(const Frame& frame,
                                           const RigidPose& from,
                                           double reach_px) const {
  Fit fit;
  fit.samples = track_samples(record_->model, visibility_, camera_, from, {});
  const EdgeSearchOptions search{.reach_px = reach_px};
  if (frame.image != nullptr) {
    fit.candidates = search_image_edges(*frame.image, fit.samples, memory_, search);
  } else {
    fit.candidates = search_edge_points(frame.features->edges, fit.samples, search);
  }
  std::vector<PosePoint> points =
      match_points(frame, from, std::min(reach_px, options_.point_reach_px));
  fit.points_matched = points.size();
  fit.alignment =
      align_model(fit.samples, fit.candidates, points, camera_, from, {.reach_px = reach_px});
  if (!fit.alignment.fixed || !(fit.alignment.pose.t.z() > 0.0)) return std::nullopt;
  return fit;
}

// Each feature to the nearest visible point of its type and back: pairs that choose each other.
std::vector<PosePoint> Tracker::match_points(const Frame& frame,
                                             const RigidPose& pose,
                                             double reach_px) const {
  std::vector<PosePoint> pairs;
  if (frame.features == nullptr || frame.features->points.empty()) return pairs;
  const std::vector<ImageFeature>& features = frame.features->points;
  const std::vector<bool> visible = visibility_.points_from(-(pose.R.transpose() * pose.t));
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> point_of(features.size(), kNone);
  std::vector<double> distance_of(features.size(), reach_px);
  std::vector<std::size_t> feature_of(points_.size(), kNone);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const SeenRay seen = seen_ray(points_[k], pose);
    if (!visible[k] || !seen.ok || !inside_lens_model(camera_, seen.ray)) continue;
    const Eigen::Vector2d uv = distort(camera_, seen.ray);
    double nearest = reach_px;
    for (std::size_t i = 0; i < features.size(); ++i) {
      if (features[i].type != record_->model.points[k].type) continue;
      const double distance = (features[i].uv - uv).norm();
      if (distance < nearest) {
        nearest = distance;
        feature_of[k] = i;
      }
      if (distance < distance_of[i]) {
        distance_of[i] = distance;
        point_of[i] = k;
      }
    }
  }
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (feature_of[k] == kNone || point_of[feature_of[k]] != k) continue;
    pairs.push_back(points_[k]);
    pairs.back().uv = features[feature_of[k]].uv;
    pairs.back().sigma_px = features[feature_of[k]].sigma_px;
  }
  return pairs;
}

// Says what a pose has found of what it shows, and whether that is enough.
void Tracker::judge(const Frame& frame, Fit& fit) const {
  const RigidPose& pose = fit.alignment.pose;
  const MonoModel& model = record_->model;
  std::vector<std::size_t> seen(model.edges.size() + model.circles.size(), 0);
  std::vector<std::size_t> hit(seen.size(), 0);
  std::size_t hits = 0;
  std::size_t looked = 0;  // places within reach of an edge: how likely a hit is by chance
  for (std::size_t i = 0; i < fit.samples.size(); ++i) {
    ++seen[fit.samples[i].curve];
    looked += fit.candidates.of(i).size();
    if (!(fit.alignment.edge_off_px[i] < kOnEdge_px)) continue;
    const bool along = std::any_of(fit.candidates.of(i).begin(),
                                   fit.candidates.of(i).end(),
                                   [](const EdgeCandidate& c) { return c.cosine > kOnEdgeCosine; });
    if (!along) continue;
    ++hit[fit.samples[i].curve];
    ++hits;
  }
  const std::size_t samples = fit.samples.size();
  if (samples > 0) fit.edge_share = static_cast<double>(hits) / static_cast<double>(samples);
  const std::vector<bool> visible = visibility_.points_from(-(pose.R.transpose() * pose.t));
  std::size_t in_view = 0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (!visible[k] || !project(camera_, pose * points_[k].xyz)) continue;
    ++in_view;
    if (frame.image == nullptr) continue;
    // A point counts as found where half of its edges, or of its circle, is.
    std::size_t of_point = 0;
    std::size_t found_of_point = 0;
    for (std::size_t e = 0; e < model.edges.size(); ++e) {
      if (model.edges[e][0] != k && model.edges[e][1] != k) continue;
      of_point += seen[e];
      found_of_point += hit[e];
    }
    for (std::size_t c = 0; c < model.circles.size(); ++c) {
      if ((model.circles[c].center - points_[k].xyz).norm() > 1e-9) continue;
      of_point += seen[model.edges.size() + c];
      found_of_point += hit[model.edges.size() + c];
    }
    if (of_point > 0 && 2 * found_of_point >= of_point) ++fit.matched;
  }
  fit.visible = in_view;
  if (frame.image == nullptr) {
    fit.matched = match_points(frame, pose, kOnPoint_px).size();
  }
  const bool by_edges = samples > 0 && (frame.image != nullptr || !frame.features->edges.empty());
  if (by_edges) {
    constexpr std::size_t kFewestSamples = 12;
    fit.believed = samples >= kFewestSamples && fit.edge_share >= options_.min_edge_share;
    if (!fit.believed) fit.reason = "too little of the visible edges was found";
    return;
  }
  const double share =
      in_view == 0 ? 0.0 : static_cast<double>(fit.matched) / static_cast<double>(in_view);
  fit.believed = fit.matched >= kFewestPoints && share >= options_.min_point_share;
  if (!fit.believed) fit.reason = "too few of the visible points were found";
}

TrackResult Tracker::found(const Frame& frame, const Fit& fit, TrackStatus status) {
  // Rounding must not add up: a rotation that is not quite one is scaled up by every prediction.
  const RigidPose now{nearest_rotation(fit.alignment.pose.R), fit.alignment.pose.t};
  if (pose_ && missed_ == 0 && status == TrackStatus::kTracked) {
    motion_.R = now.R * pose_->R.transpose();
    motion_.t = now.t - motion_.R * pose_->t;
  } else {
    motion_ = still();
  }
  pose_ = now;
  missed_ = 0;
  last_share_ = fit.share();
  if (frame.image != nullptr) {
    memory_.clear();
    for (const TrackSample& sample : track_samples(record_->model, visibility_, camera_, now, {})) {
      memory_.remember(sample, look_at_edge(*frame.image, sample, 0.0));
    }
  }
  TrackResult result;
  result.status = status;
  result.T_camera_object = now.isometry();
  result.covariance = fit.alignment.covariance;
  result.rms_px = fit.alignment.rms_px;
  result.matched = fit.matched;
  result.visible_points = fit.visible;
  result.edge_share = fit.edge_share;
  result.confidence = confidence_;
  return result;
}

TrackResult Tracker::missed(const Frame& frame, const RigidPose& predicted, const RunContext& run) {
  TrackResult result;
  if (pose_) {
    ++missed_;
    if (missed_ < options_.patience) {
      // Where it would be by now; a constant velocity holds for a frame or two.
      pose_ = predicted;
      result.status = TrackStatus::kPredicted;
      result.reason = "the object was not seen where it should be";
      result.T_camera_object = predicted.isometry();
      result.confidence = confidence_;
      return result;
    }
    pose_.reset();
  }
  if (recognizer_ == nullptr) {
    result.reason = "there is no pose to start from, and nothing to recognise it with";
    return result;
  }
  return recognised(frame, run);
}

TrackResult Tracker::recognised(const Frame& frame, const RunContext& run) {
  const RecognizeResult answer =
      frame.image != nullptr
          ? recognizer_->recognize(*frame.image, camera_, options_.recognize, run)
          : recognizer_->recognize(*frame.features, camera_, options_.recognize, run);
  TrackResult result;
  if (answer.status != RecognizeStatus::kRecognized || answer.hypotheses.empty()) {
    result.reason = "not recognised: " + answer.reason;
    return result;
  }
  const MonoHypothesis& best = answer.hypotheses.front();
  start_from(best.T_camera_object);
  confidence_ = best.confidence;
  // The same refinement as in the frames to come, so that the pose does not jump with them.
  const std::optional<Fit> fit = follow(frame, *pose_);
  if (fit && fit->believed) return found(frame, *fit, TrackStatus::kRecognized);
  result.status = TrackStatus::kRecognized;
  result.T_camera_object = best.T_camera_object;
  result.covariance = best.covariance;
  result.rms_px = best.rms_px;
  result.matched = best.pairs.size();
  result.visible_points = best.visible_points;
  result.edge_share = best.edge_share;
  result.confidence = confidence_;
  return result;
}

}  // namespace landmarkdb
