#include <string>

#include "client/convert.hpp"

namespace landmarkdb::client {
namespace {

Eigen::Vector3d vector(const v1::Vector3& v) { return {v.x(), v.y(), v.z()}; }

// A square matrix that travels row by row.
template <int kSize, typename Repeated>
Eigen::Matrix<double, kSize, kSize> matrix(const Repeated& numbers, const char* field) {
  if (numbers.size() != kSize * kSize) {
    throw Error(ErrorCode::kInternal,
                std::string("the server's ") + field + " has " + std::to_string(numbers.size()) +
                    " numbers, want " + std::to_string(kSize * kSize));
  }
  return Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>>(numbers.data());
}

StageTimings timings(const v1::StageTimings& t) {
  using Duration = StageTimings::Duration;
  return {.load = Duration(t.load_ms()),
          .preprocess = Duration(t.preprocess_ms()),
          .keypoints = Duration(t.keypoints_ms()),
          .describe = Duration(t.describe_ms()),
          .match = Duration(t.match_ms()),
          .filter = Duration(t.filter_ms()),
          .pose = Duration(t.pose_ms()),
          .icp = Duration(t.icp_ms()),
          .verify = Duration(t.verify_ms()),
          .total = Duration(t.total_ms())};
}

Hypothesis hypothesis(const v1::Hypothesis& h) {
  Hypothesis out;
  out.scene = h.scene();
  out.scene_version = h.scene_version();
  if (h.has_landmark()) out.landmark = h.landmark();
  out.confidence = h.confidence();
  out.T_scene_sensor = matrix<4>(h.t_scene_sensor(), "t_scene_sensor");
  out.chain.T_landmark_sensor = matrix<4>(h.chain().t_landmark_sensor(), "t_landmark_sensor");
  out.chain.T_scene_landmark = matrix<4>(h.chain().t_scene_landmark(), "t_scene_landmark");
  out.chain.T_icp = matrix<4>(h.chain().t_icp(), "t_icp");
  out.chain.scale = h.chain().scale();
  const v1::CorrespondenceCounts& counts = h.correspondences();
  out.counts = {.putative = counts.putative(),
                .after_ratio = counts.after_ratio(),
                .after_slope = counts.after_slope(),
                .after_consistency = counts.after_consistency(),
                .inliers = counts.inliers()};
  out.fit = {.overlap = h.fit().overlap(),
             .rmse_m = h.fit().rmse_m(),
             .free_space_violation = h.fit().free_space_violation(),
             .explained = h.fit().explained(),
             .coverage = h.fit().coverage(),
             .quality = h.fit().quality(),
             .margin = h.fit().margin(),
             .agreeing = h.fit().agreeing(),
             .contrast = h.fit().contrast(),
             .contradicted = h.fit().contradicted(),
             .refuted = h.fit().refuted(),
             .observability = h.fit().observability()};
  out.covariance = matrix<6>(h.covariance(), "covariance");
  out.rival = h.rival();
  return out;
}

CorrespondenceRecord correspondence(const v1::Correspondence& pair) {
  return {.scene = pair.scene(),
          .sensor_m = vector(pair.sensor_m()).cast<float>(),
          .scene_m = vector(pair.scene_m()),
          .distance = pair.distance(),
          .dropped_by = pair.dropped_by()};
}

QueryStatus status(v1::QueryStatus value) {
  switch (value) {
    case v1::QUERY_STATUS_LOCALIZED:
      return QueryStatus::kLocalized;
    case v1::QUERY_STATUS_AMBIGUOUS:
      return QueryStatus::kAmbiguous;
    case v1::QUERY_STATUS_NOT_FOUND:
      return QueryStatus::kNotFound;
    default:
      throw Error(ErrorCode::kInternal,
                  "the server's answer has status " + std::to_string(value) + ", want 1, 2 or 3");
  }
}

KeypointMethod keypoint_method(v1::KeypointMethod method) {
  switch (method) {
    case v1::KEYPOINT_METHOD_UNIFORM:
      return KeypointMethod::kUniform;
    case v1::KEYPOINT_METHOD_ISS:
      return KeypointMethod::kIss;
    case v1::KEYPOINT_METHOD_NARF:
      return KeypointMethod::kNarf;
    default:
      return KeypointMethod::kStructure;
  }
}

SceneVersion scene_version(const v1::SceneVersion& version) {
  return {.version = version.version(),
          .created = version.created(),
          .active = version.active(),
          .points = version.points(),
          .keypoints = version.keypoints(),
          .bytes = version.bytes(),
          .retired = version.retired(),
          .damage = version.damage()};
}

std::string health_name(v1::HealthStatus value) {
  switch (value) {
    case v1::HEALTH_STATUS_OK:
      return "ok";
    case v1::HEALTH_STATUS_STARTING:
      return "starting";
    case v1::HEALTH_STATUS_DEGRADED:
      return "degraded";
    case v1::HEALTH_STATUS_STOPPING:
      return "stopping";
    case v1::HEALTH_STATUS_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

}  // namespace

QueryResult from_proto(const v1::QueryResult& result) {
  QueryResult out;
  out.status = status(result.status());
  out.reason = result.reason();
  for (const v1::Hypothesis& h : result.hypotheses()) out.hypotheses.push_back(hypothesis(h));
  if (out.status != QueryStatus::kNotFound && out.hypotheses.empty()) {
    throw Error(ErrorCode::kInternal, "the server's answer found a place but holds no hypothesis");
  }
  out.query = {.points = result.query().points(),
               .points_used = result.query().points_used(),
               .invalid = result.query().invalid(),
               .keypoints = result.query().keypoints(),
               .density_ratio = result.query().density_ratio()};
  out.seed = result.query().seed();
  out.warnings.assign(result.warnings().begin(), result.warnings().end());
  for (const v1::Correspondence& pair : result.correspondences()) {
    out.correspondences.push_back(correspondence(pair));
  }
  for (const v1::SceneView& view : result.scene_views()) {
    out.scene_views.push_back(from_proto(view));
  }
  if (result.has_explanation()) out.explanation = from_proto(result.explanation());
  out.timings = timings(result.timing());
  return out;
}

SceneInfo from_proto(const v1::SceneInfo& scene) {
  SceneInfo out;
  out.name = scene.name();
  out.scene_id = scene.scene_id();
  out.version = scene.version();
  out.kind = scene.kind() == v1::ENTRY_KIND_OBJECT ? EntryKind::kObject : EntryKind::kPlace;
  out.quarantined = scene.state() == v1::SCENE_STATE_QUARANTINED;
  out.state_reason = scene.state_reason();
  out.points = scene.points();
  out.keypoints = scene.keypoints();
  out.bytes = scene.bytes();
  out.created = scene.created();
  out.options = {.voxel_m = scene.options().voxel_m(),
                 .normal_radius_m = scene.options().normal_radius_m(),
                 .shot_radius_m = scene.options().shot_radius_m(),
                 .keypoint_spacing_m = scene.options().keypoint_spacing_m(),
                 .keypoints = keypoint_method(scene.options().keypoints())};
  out.tags = {scene.tags().begin(), scene.tags().end()};
  for (const v1::Landmark& landmark : scene.landmarks()) {
    out.landmarks.push_back({.name = landmark.name(),
                             .min_m = vector(landmark.min_m()),
                             .max_m = vector(landmark.max_m())});
  }
  out.sources.assign(scene.sources().begin(), scene.sources().end());
  out.warnings.assign(scene.warnings().begin(), scene.warnings().end());
  if (scene.has_up()) out.up = vector(scene.up());
  if (scene.has_min_m()) out.min_m = vector(scene.min_m());
  if (scene.has_max_m()) out.max_m = vector(scene.max_m());
  for (const v1::SceneVersion& version : scene.versions()) {
    out.versions.push_back(scene_version(version));
  }
  return out;
}

Stats from_proto(const v1::StatsReply& stats) {
  return {.server_version = stats.server_version(),
          .uptime_s = stats.uptime_s(),
          .generation = stats.generation(),
          .scenes = stats.scenes(),
          .quarantined = stats.quarantined(),
          .points = stats.points(),
          .keypoints = stats.keypoints(),
          .connections = stats.connections(),
          .connections_total = stats.connections_total(),
          .requests_total = stats.requests_total(),
          .errors_total = stats.errors_total(),
          .queries_localized = stats.queries_localized(),
          .queries_ambiguous = stats.queries_ambiguous(),
          .queries_not_found = stats.queries_not_found(),
          .in_flight = stats.in_flight(),
          .queued = stats.queued(),
          .rejected_total = stats.rejected_total(),
          .threads = stats.threads(),
          .query_ms_mean = stats.query_ms_mean(),
          .query_ms_max = stats.query_ms_max(),
          .models = stats.models(),
          .recognized = stats.recognized(),
          .recognize_not_found = stats.recognize_not_found(),
          .recognize_ms_mean = stats.recognize_ms_mean(),
          .recognize_ms_max = stats.recognize_ms_max(),
          .tracks_open = stats.tracks_open(),
          .track_frames = stats.track_frames(),
          .track_frames_seen = stats.track_frames_seen(),
          .track_ms_mean = stats.track_ms_mean(),
          .track_ms_max = stats.track_ms_max(),
          .resident_bytes = stats.resident_bytes(),
          .database_bytes = stats.database_bytes(),
          .reloads_total = stats.reloads_total(),
          .scenes_on_demand = stats.scenes_on_demand(),
          .scene_memory_bytes = stats.scene_memory_bytes(),
          .scene_loads = stats.scene_loads()};
}

Health from_proto(const v1::HealthReply& health) {
  return {.status = health_name(health.status()),
          .ready = health.ready(),
          .problems = {health.problems().begin(), health.problems().end()},
          .quarantined = {health.quarantined().begin(), health.quarantined().end()}};
}

Error from_proto(const v1::Error& error) {
  const int number = error.code();
  const bool known = number >= static_cast<int>(ErrorCode::kCancelled) &&
                     number <= static_cast<int>(ErrorCode::kUnauthenticated);
  const ErrorCode code = known ? static_cast<ErrorCode>(number) : ErrorCode::kUnknown;
  const std::string message =
      error.message().empty() ? "the server failed and did not say why" : error.message();
  return Error(code, message, error.field());
}

}  // namespace landmarkdb::client
