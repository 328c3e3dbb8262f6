#include "server/convert_scene.hpp"

#include <cmath>
#include <utility>

#include "engine/base/error.hpp"
#include "server/check_field.hpp"
#include "server/convert_query.hpp"

namespace landmarkdb {

namespace {

// As many clouds as the viewpoint index of a cloud can tell apart would be 65,536; a request stays
// far below that.
constexpr int kMaxScans = 4096;
constexpr double kMaxLength_m = 1e6;
constexpr double kMinDirection = 1e-9;
constexpr std::size_t kMaxSourceBytes = 1024;

double positive_length(double value, const std::string& field) {
  if (!(value > 0.0 && value <= kMaxLength_m)) {
    refuse(field, "is " + std::to_string(value) + ", want metres above 0, at most 1e6");
  }
  return value;
}

EntryKind kind_from(v1::EntryKind kind) {
  switch (kind) {
    case v1::ENTRY_KIND_UNSPECIFIED:
    case v1::ENTRY_KIND_PLACE:
      return EntryKind::kPlace;
    case v1::ENTRY_KIND_OBJECT:
      return EntryKind::kObject;
    default:
      refuse("kind", "no kind has the number " + std::to_string(kind));
  }
}

Scan scan_from(const v1::SceneAddScan& message,
               PointAllowance& allowance,
               const std::string& field) {
  Scan scan;
  scan.cloud = from_proto(message.cloud(), allowance, field + ".cloud");
  const auto& numbers = message.t_scene_cloud();
  if (!numbers.empty()) {
    scan.T_scene_cloud = pose_from_proto({numbers.data(), static_cast<std::size_t>(numbers.size())},
                                         field + ".t_scene_cloud");
  }
  // Names are for the record; folders of another machine mean nothing here.
  scan.source = message.source().substr(message.source().find_last_of('/') + 1);
  if (scan.source.size() > kMaxSourceBytes) {
    refuse(field + ".source", "is longer than " + std::to_string(kMaxSourceBytes) + " bytes");
  }
  return scan;
}

void set_options(const FeatureOptions& options, v1::FeatureOptions& message) {
  message.set_voxel_m(options.voxel_m);
  message.set_normal_radius_m(options.normal_radius_m);
  message.set_shot_radius_m(options.shot_radius_m);
  message.set_keypoint_spacing_m(options.keypoint_spacing_m);
  message.set_keypoints(to_proto(options.keypoints));
}

void set_version(const VersionSummary& version, v1::SceneVersion& message) {
  message.set_version(version.version);
  message.set_created(version.created);
  message.set_active(version.active);
  message.set_points(version.points);
  message.set_keypoints(version.keypoints);
  message.set_bytes(version.bytes);
  message.set_retired(version.retired);
  message.set_damage(version.damage.value_or(""));
}

}  // namespace

SceneAddition from_proto(const v1::SceneAddRequest& request, PointAllowance& allowance) {
  SceneAddition addition;
  addition.name = request.name();
  if (request.scans().empty()) refuse("scans", "there is none, want at least one");
  if (request.scans_size() > kMaxScans) {
    refuse("scans",
           "there are " + std::to_string(request.scans_size()) + ", want at most " +
               std::to_string(kMaxScans));
  }
  addition.options.kind = kind_from(request.kind());
  if (request.has_voxel_m()) {
    addition.options.voxel_m = positive_length(request.voxel_m(), "voxel_m");
  }
  if (request.has_radius_m()) {
    addition.options.radius_m = positive_length(request.radius_m(), "radius_m");
  }
  addition.options.keypoints =
      from_proto(request.keypoints(), IndexOptions{}.keypoints, "keypoints");
  if (request.has_up()) {
    addition.options.up = from_proto(request.up(), "up");
    if (addition.options.up->norm() < kMinDirection) refuse("up", "has no length");
  }
  for (int i = 0; i < request.scans_size(); ++i) {
    addition.scans.push_back(
        scan_from(request.scans(i), allowance, "scans[" + std::to_string(i) + "]"));
  }
  return addition;
}

Landmark from_proto(const v1::Landmark& message) {
  Landmark landmark;
  landmark.name = message.name();
  landmark.min_m = from_proto(message.min_m(), "landmark.min_m");
  landmark.max_m = from_proto(message.max_m(), "landmark.max_m");
  if (!(landmark.min_m.array() < landmark.max_m.array()).all()) {
    refuse("landmark", "want min below max on every axis");
  }
  return landmark;
}

v1::SceneInfo to_proto(const SceneSummary& scene,
                       bool with_versions,
                       const std::string& quarantined) {
  v1::SceneInfo message;
  message.set_name(scene.name);
  message.set_scene_id(scene.id);
  message.set_version(scene.active_version);
  message.set_kind(scene.kind == EntryKind::kObject ? v1::ENTRY_KIND_OBJECT : v1::ENTRY_KIND_PLACE);
  const std::string damage = scene.damage.value_or(quarantined);
  message.set_state(damage.empty() ? v1::SCENE_STATE_ACTIVE : v1::SCENE_STATE_QUARANTINED);
  message.set_state_reason(damage);
  message.set_points(scene.points);
  message.set_keypoints(scene.keypoints);
  message.set_bytes(scene.bytes);
  message.set_created(scene.created);
  set_options(scene.options, *message.mutable_options());
  for (const auto& [key, value] : scene.tags) (*message.mutable_tags())[key] = value;
  for (const Landmark& landmark : scene.landmarks) {
    v1::Landmark& out = *message.add_landmarks();
    out.set_name(landmark.name);
    *out.mutable_min_m() = to_proto(landmark.min_m);
    *out.mutable_max_m() = to_proto(landmark.max_m);
  }
  for (const std::string& source : scene.sources) message.add_sources(source);
  for (const std::string& warning : scene.warnings) message.add_warnings(warning);
  if (scene.up) *message.mutable_up() = to_proto(*scene.up);
  if (with_versions) {
    for (const VersionSummary& version : scene.versions) {
      set_version(version, *message.add_versions());
    }
  }
  return message;
}

}  // namespace landmarkdb
